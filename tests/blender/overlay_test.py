#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Blender in a window: the overlay while a lamp is dragged by mouse. CHANDELIER_KEEP_SHOTS names a folder for the pictures."""

import json
import os
import pathlib
import sys
import tempfile
import unittest

import numpy as np
from PIL import Image

import window_tool

SKIPPED = 77


def picture(path):
    return np.asarray(Image.open(path).convert("RGB"), "f4") / 255


def view(image):
    """The 3D view's part, without toolbar, header and gizmos."""
    return image[150:700, 60:1000]


def colourful(image):
    return image.max(2) - image.min(2) > 0.3


def red(image):
    return (image[..., 0] > 0.8) & (image[..., 1:].max(2) < 0.3)


class Drag(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        missing = window_tool.missing()
        if missing:
            raise unittest.SkipTest(f"no {missing} in PATH")
        folder = os.environ.get("CHANDELIER_KEEP_SHOTS")
        cls.temporary = None if folder else tempfile.TemporaryDirectory()
        cls.shots = pathlib.Path(folder or cls.temporary.name)
        cls.shots.mkdir(parents=True, exist_ok=True)
        done = window_tool.run("drag.py", cls.shots)
        assert done.returncode == 0, done.stdout + done.stderr
        cls.log = {entry["name"]: entry for entry in json.loads((cls.shots / "log.json").read_text())}
        cls.drags = [cls.log[f"drag {step}"] for step in range(1, 13)]

    @classmethod
    def tearDownClass(cls):
        if cls.temporary:
            cls.temporary.cleanup()

    def test_the_lamp_is_dragged(self):
        places = [entry["place"][0] for entry in self.drags]
        self.assertEqual(places, sorted(places))
        self.assertGreater(places[-1] - places[0], 1)

    def test_the_bill_follows_the_mouse(self):
        maps = [entry["maps"] for entry in self.drags]
        self.assertEqual((self.log["before"]["maps"], maps[0], maps[-1]), (2, 2, 3))
        self.assertEqual(maps, sorted(maps))

    def test_the_overlay_is_in_the_picture(self):
        before = colourful(view(picture(self.shots / "before.png")))
        self.assertGreater(before.sum(), 1500)

    def test_the_new_map_is_drawn_while_the_button_is_down(self):
        before, dragging = (colourful(view(picture(self.shots / f"{name}.png"))) for name in ("before", "dragging"))
        self.assertGreater((dragging & ~before).sum(), 500)

    def test_undo_and_redo_are_drawn_each_time(self):
        before, after = (colourful(view(picture(self.shots / f"{name}.png"))) for name in ("before", "after"))
        for number in range(2):
            for step, expected, other, maps in (("undo", before, after, 2), ("redo", after, before, 3)):
                name = f"{step} {number}"
                shown = colourful(view(picture(self.shots / f"{name}.png")))
                self.assertEqual(self.log[name]["maps"], maps, name)
                self.assertLess((shown ^ expected).sum(), 0.2 * (shown ^ other).sum(), name)

    def test_over_budget_lights_are_red(self):
        after, over_budget = (red(view(picture(self.shots / f"{name}.png"))) for name in ("after", "over_budget"))
        self.assertEqual((self.log["over_budget"]["maps"], self.log["over_budget"]["over_budget"]), (1, 2))
        self.assertLess(after.sum(), 50)  # an axis of the grid
        self.assertGreater((over_budget & ~after).sum(), 500)


if __name__ == "__main__":
    result = unittest.main(exit=False, verbosity=2).result
    sys.exit(0 if result.wasSuccessful() and result.testsRun else SKIPPED if result.wasSuccessful() else 1)
