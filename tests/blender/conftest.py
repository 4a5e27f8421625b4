# SPDX-License-Identifier: Apache-2.0
"""The add-on's core is imported as a package of its own, since the add-on's __init__ needs Blender."""

import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "blender_addon" / "chandelier"))
collect_ignore_glob = ["in_blender/*", "in_window/*", "*_test.py"]  # CTest runs the last by themselves
