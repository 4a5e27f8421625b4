# SPDX-License-Identifier: Apache-2.0
"""Types of command-line arguments."""

import argparse
import re


def size(text):
    if not re.fullmatch(r"[1-9]\d{0,4}x[1-9]\d{0,4}", text):
        raise argparse.ArgumentTypeError(f"must be WIDTHxHEIGHT ({text})")
    return text


def positive(text):
    if not text.isdecimal() or int(text) < 1:
        raise argparse.ArgumentTypeError(f"must be a whole number above 0 ({text})")
    return int(text)
