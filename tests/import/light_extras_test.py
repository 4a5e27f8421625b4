# SPDX-License-Identifier: Apache-2.0
# schemas/light_extras.schema.json and chandelier-bake must agree on what a light may carry in `extras.chandelier`.
import json
import os
import pathlib
import re
import subprocess
import tempfile
import unittest

import jsonschema

BAKE = os.environ["CHANDELIER_BAKE"]
SCHEMA = json.loads((pathlib.Path(os.environ["CHANDELIER_SCHEMAS"]) / "light_extras.schema.json").read_text())

GOOD = [
    {},
    {"priority": 0}, {"priority": 255}, {"priority": 128.0},
    {"dynamic": True}, {"dynamic": False}, {"cluster": False}, {"cluster": True},
    {"shadow": False}, {"shadow": True}, {"radius_m": 0}, {"radius_m": 0.05}, {"radius_m": 1e6},
    {"power_w": 0}, {"power_w": 60}, {"power_w": 1e12}, {"power_w": 0.5},
    {"range_m": 1e-12}, {"range_m": 3e38}, {"range_m": 7}, {"range_m": 0},
    {"group": ""}, {"group": "lamp"}, {"group": "Leuchter über dem Tisch"},
    {"priority": 200, "dynamic": False, "cluster": False, "power_w": 60, "range_m": 12.5},
]
BAD = [  # and the key that both name
    ({"priority": 256}, "priority"), ({"priority": -1}, "priority"), ({"priority": 1.5}, "priority"),
    ({"priority": "high"}, "priority"), ({"priority": True}, "priority"), ({"priority": None}, "priority"),
    ({"priority": 1e300}, "priority"), ({"priority": [1]}, "priority"),
    ({"dynamic": 1}, "dynamic"), ({"dynamic": "yes"}, "dynamic"), ({"dynamic": None}, "dynamic"),
    ({"cluster": 0}, "cluster"), ({"cluster": {}}, "cluster"),
    ({"shadow": 0}, "shadow"), ({"shadow": "no"}, "shadow"), ({"shadow": None}, "shadow"),
    ({"radius_m": -0.1}, "radius_m"), ({"radius_m": 2e6}, "radius_m"), ({"radius_m": True}, "radius_m"),
    ({"power_w": -1}, "power_w"), ({"power_w": 2e12}, "power_w"), ({"power_w": "60 W"}, "power_w"),
    ({"power_w": False}, "power_w"),
    ({"range_m": 1e-13}, "range_m"), ({"range_m": -3}, "range_m"), ({"range_m": 4e38}, "range_m"),
    ({"range_m": []}, "range_m"),
    ({"group": 3}, "group"), ({"group": None}, "group"), ({"group": ["a"]}, "group"),
    ([], None), (7, None), ("priority", None), (None, None), (True, None),
]
EMPTINESS = re.compile(r"^chandelier-bake: warning: scene: (triangles|lights): there are none.*\n", re.MULTILINE)
UNKNOWN = [{"Priority": 1}, {"rang_m": 5, "priority": 3}, {"range": 5}, {"": 0}]


def scene(lamps):
    """A glTF with a light and a node for each lamp, (extras of the light, extras of the node); `...` leaves one out."""
    lights, nodes = [], []
    for number, both in enumerate(lamps):
        lights.append({"type": "point", "name": "bulb", "intensity": 5 + number})
        nodes.append({"name": "lamp", "extensions": {"KHR_lights_punctual": {"light": number}}})
        for target, extras in zip((lights[-1], nodes[-1]), both):
            if extras is not ...:
                target["extras"] = {"chandelier": extras, "made_by": "someone else"}
    return {
        "asset": {"version": "2.0"},
        "extensionsUsed": ["KHR_lights_punctual"],
        "extensions": {"KHR_lights_punctual": {"lights": lights}},
        "nodes": nodes,
    }


class LightExtras(unittest.TestCase):
    def setUp(self):
        jsonschema.Draft202012Validator.check_schema(SCHEMA)
        self.validator = jsonschema.Draft202012Validator(SCHEMA)
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def bake(self, gltf):
        path = self.folder / "scene.gltf"
        path.write_text(json.dumps(gltf))
        done = subprocess.run([BAKE, "-q", path, "-o", self.folder / "out.chandelier"], capture_output=True, text=True)
        done.stderr = EMPTINESS.sub("", done.stderr)
        return done

    def test_both_accept_what_is_good(self):
        good = GOOD + SCHEMA["examples"]
        for extras in good:
            self.assertTrue(self.validator.is_valid(extras), extras)
        result = self.bake(scene([(extras, ...) for extras in good] + [(..., extras) for extras in good]))
        self.assertEqual(result.returncode, 0)
        self.assertRegex(result.stderr, r"\A[^\n]*light \d+ 'bulb' \(and 1 more\): a light's range of 0 is taken as none[^\n]*\n\Z")

    def test_both_refuse_what_is_bad_and_name_the_key(self):
        for number, (extras, key) in enumerate(BAD):
            with self.subTest(extras):
                errors = list(self.validator.iter_errors(extras))
                self.assertEqual([list(error.absolute_path) for error in errors], [[key] if key else []])
                on_light = number % 2 == 0
                result = self.bake(scene([(extras, ...) if on_light else (..., extras)]))
                self.assertEqual((result.returncode, result.stderr.count("\n")), (1, 1))
                place = "light 0 'bulb'" if on_light else "node 0 'lamp'"
                self.assertIn(f"{place}, extras.chandelier" + (f", {key}: " if key else ": "), result.stderr)

    def test_a_key_that_the_schema_does_not_list_is_a_warning_with_its_name(self):
        for extras in UNKNOWN:
            with self.subTest(extras):
                self.assertTrue(self.validator.is_valid(extras))
                result = self.bake(scene([(..., extras)]))
                self.assertEqual(result.returncode, 0)
                unknown = [key for key in extras if key not in SCHEMA["properties"]]
                self.assertEqual(result.stderr.count("unknown key is ignored"), 1)
                for key in unknown:
                    self.assertIn(f"({key or 'an empty name'})", result.stderr)

    def test_extras_of_a_node_without_a_light_are_nobodys_business(self):
        result = self.bake({"asset": {"version": "2.0"}, "nodes": [{"extras": {"chandelier": "brass"}}]})
        self.assertEqual((result.returncode, result.stderr), (0, ""))


if __name__ == "__main__":
    unittest.main()
