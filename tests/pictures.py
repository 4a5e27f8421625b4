# SPDX-License-Identifier: Apache-2.0
"""Pictures as numpy arrays, for tests that run the player."""
import numpy


def read_pfm(path):
    """Linear RGB, rows from the top."""
    with open(path, "rb") as file:
        assert file.readline() == b"PF\n"
        width, height = map(int, file.readline().split())
        assert float(file.readline()) == -1.0
        return numpy.frombuffer(file.read(), "<f4").reshape(height, width, 3)[::-1]
