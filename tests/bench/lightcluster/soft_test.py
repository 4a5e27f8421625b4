# SPDX-License-Identifier: Apache-2.0
"""The table of soft.py, from statistics made by hand."""

import sys
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent))
import scenes
import soft


def frame(frame_ms, maps, **stages):
    return {"frame_ms": frame_ms, "counters": {"shadow_maps": maps},
            "stages": [{"name": name.replace("_", "-"), "gpu_ms": ms} for name, ms in stages.items()]}


def row(scene, preset, frames):
    made = soft.Row(scenes.by_name(scene), preset)
    made.frames = frames
    return made


class Table(unittest.TestCase):
    def setUp(self):
        self.rows = [
            row("cornell", "reference", [frame(900.0, 32, rasterize=500.0), frame(1000.0, 32, rasterize=700.0), frame(5000.0, 32, rasterize=600.0)]),
            row("cornell", "lightcluster", [frame(250.0, 5, shade=80.0, g_buffer=10.0)]),
            row("atrium", "reference", [frame(300.0, 80)]),
            row("atrium", "lightcluster", [frame(600.0, 26)])]

    def test_each_row_is_held_against_its_own_scenes_reference(self):
        lines = soft.table(self.rows)
        self.assertEqual([line.split()[-1] for line in lines[1:]], ["1.00", "4.00", "1.00", "0.50"])

    def test_times_are_medians_and_a_stage_that_a_frame_has_not_took_no_time(self):
        lines = soft.table(self.rows)
        self.assertEqual(lines[0].split(), ["scene", "recipe", "maps", "frame", "g-buffer", "rasterize", "deliver", "shade", "times"])
        self.assertEqual(lines[1].split()[2:], ["32", "1000.0", "0.0", "600.0", "0.0", "0.0", "1.00"])
        self.assertEqual(lines[2].split()[2:], ["5", "250.0", "10.0", "0.0", "0.0", "80.0", "4.00"])

    def test_sponza_has_the_numbers_of_maps_that_goals_are_stated_for(self):
        class Player:
            def budget(self, maps):
                return {"d_init_m": 1.0 / maps}

        rows = soft.rows_of(scenes.by_name("sponza"), Player())
        self.assertEqual([(made.preset, made.options[1:2]) for made in rows],
                         [("reference", ()), ("lightcluster", (1 / 26,)), ("lightcluster-pcf", (1 / 26,)),
                          ("lightcluster", (1 / 10,)), ("lightcluster-pcf", (1 / 10,))])
        self.assertEqual([made.preset for made in soft.rows_of(scenes.by_name("atrium"), Player())],
                         ["reference", "lightcluster", "lightcluster-pcf"])


if __name__ == "__main__":
    unittest.main()
