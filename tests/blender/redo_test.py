#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Blender in a window: values are changed by mouse in the redo panel of each operator. CHANDELIER_KEEP_SHOTS names a folder for the
pictures."""

import json
import os
import pathlib
import sys
import tempfile
import unittest

import window_tool

SKIPPED = 77
PLACED = {"place_along_curve": 8, "place_around": 8, "place_on_mesh": 3, "scatter": 5}  # by a count, lights at first


class Redo(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        missing = window_tool.missing()
        if missing:
            raise unittest.SkipTest(f"no {missing} in PATH")
        temporary = tempfile.TemporaryDirectory()
        cls.addClassCleanup(temporary.cleanup)
        shots = pathlib.Path(os.environ.get("CHANDELIER_KEEP_SHOTS") or temporary.name)
        shots.mkdir(parents=True, exist_ok=True)
        done = window_tool.run("redo.py", shots)
        assert done.returncode == 0, done.stdout + done.stderr
        log = json.loads((shots / "log.json").read_text())
        cls.adjustable, cls.cases = log["adjustable"], log["cases"]

    def steps(self, operator, field, *steps):
        return [self.cases[operator][step][field] for step in steps]

    def test_every_operator_that_can_be_adjusted_is_tried(self):
        self.assertEqual(sorted(self.cases), self.adjustable)

    def test_the_redo_panel_is_there(self):
        for name in self.cases:
            self.assertGreater(self.cases[name]["made"]["panel_px"], 40, name)

    def test_another_count_places_as_many_lights(self):
        for name, count in PLACED.items():
            self.assertEqual(self.steps(name, "lights", "made", "adjusted", "again"), [count, count + 1, count + 2], name)
            self.assertEqual(self.steps(name, "selected", "made", "adjusted", "again"), [count, count + 1, count + 2], name)

    def test_lights_stay_at_their_object(self):
        for name in PLACED:
            for places in self.steps(name, "places", "made", "adjusted", "again"):
                self.assertTrue(all(abs(x - 8) < 3 for x, _, _ in places), (name, places))

    def test_a_light_at_an_object_moves(self):
        places = self.steps("place_at_selected", "places", "made", "adjusted", "again")
        self.assertEqual(places, [[[8, 0, 1]], [[8, 0, 1.5]], [[8, 0, 1]]])

    def test_edits_begin_anew_from_what_was_there_before(self):
        for name in ("edit_lights", "strength"):
            (made,), (adjusted,), (again,) = self.steps(name, "watts", "made", "adjusted", "again")
            self.assertEqual(made, 200, name)
            self.assertTrue(200 < adjusted < again < 220, (name, adjusted, again))

    def test_remedies_work_on_the_lights_that_they_had_mended(self):
        (made,), (adjusted,), (again,) = self.steps("set_range", "ranges", "made", "adjusted", "again")
        self.assertTrue(made > adjusted > again, (made, adjusted, again))  # each at more lux than the one before
        self.assertEqual(self.steps("convert_area", "kinds", "made", "adjusted", "again"), [["SPOT"], ["POINT"], ["SPOT"]])

    def test_all_of_it_is_one_step_to_undo(self):
        for name in (*PLACED, "place_at_selected"):
            self.assertEqual(self.steps(name, "lights", "undone"), [0], name)
        for name in ("edit_lights", "strength"):
            self.assertEqual(self.steps(name, "watts", "undone"), [[100]], name)
        self.assertEqual(self.steps("convert_area", "kinds", "undone"), [["AREA"]])


if __name__ == "__main__":
    result = unittest.main(exit=False, verbosity=2).result
    sys.exit(0 if result.wasSuccessful() and result.testsRun else SKIPPED if result.wasSuccessful() else 1)
