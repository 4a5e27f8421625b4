#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Makes the pictures of blender_addon/README.md: the tour in a window, and the Cornell box beside Cycles."""

import os
import pathlib
import subprocess
import sys
import tempfile

from PIL import Image

import window_tool

IMAGES = window_tool.HERE.parents[1] / "blender_addon" / "images"
SCREEN = (1440, 1500)  # all panels are seen
COLOURS = 256  # of a screenshot: an eighth of the bytes, and no difference to see
SHADED = ("09_play", "10_cycles", "cornell_cycles")  # too smooth for that


def tour(folder):
    done = window_tool.run("tour.py", folder, screen=SCREEN, timeout=900)
    if done.returncode != 0:
        sys.exit(done.stdout + done.stderr)


def cornell(folder):
    variables = dict(os.environ, CHANDELIER_CYCLES_REPORT=str(folder))
    subprocess.run([sys.executable, window_tool.HERE / "run_in_blender.py", "cycles_tests.py",
                    "Cornell.test_radiance_and_shadows_are_those_of_cycles"], env=variables, check=True, capture_output=True)
    (folder / "cornell.png").rename(folder / "cornell_cycles.png")


def main():
    IMAGES.mkdir(exist_ok=True)
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        tour(folder)
        cornell(folder)
        for path in sorted(folder.glob("*.png")):
            image = Image.open(path).convert("RGB")
            if path.name.startswith("cornell"):
                image = image.resize((image.width * 2, image.height * 2), Image.Resampling.NEAREST)
            image = image if path.stem in SHADED else image.quantize(COLOURS)
            image.save(IMAGES / path.name, optimize=True)
            print(IMAGES / path.name)


if __name__ == "__main__":
    main()
