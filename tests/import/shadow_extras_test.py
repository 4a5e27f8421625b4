# SPDX-License-Identifier: Apache-2.0
# schemas/shadow_extras.schema.json and chandelier-bake must agree on what a mesh's node and a material may carry in
# `extras.chandelier`, and the pack must say what they said.
import json
import os
import pathlib
import subprocess
import tempfile
import unittest

import jsonschema

BAKE, INSPECT = os.environ["CHANDELIER_BAKE"], os.environ["CHANDELIER_INSPECT"]
SCHEMA = json.loads((pathlib.Path(os.environ["CHANDELIER_SCHEMAS"]) / "shadow_extras.schema.json").read_text())

GOOD = [{}, {"shadow": True}, {"shadow": False}]
BAD = [  # and the key that both name
    ({"shadow": 0}, "shadow"), ({"shadow": 1}, "shadow"), ({"shadow": "no"}, "shadow"), ({"shadow": None}, "shadow"),
    ({"shadow": [False]}, "shadow"), ({"shadow": {}}, "shadow"),
    ([], None), (False, None), ("shadow", None), (None, None),
]
TRIANGLE = "data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA"


def scene(nodes=..., materials=..., **more):
    """A triangle on a node, with the extras of the node and of the material; `...` leaves one out."""
    gltf = {
        "asset": {"version": "2.0"},
        "nodes": [{"name": "shade", "mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "material": 0}]}],
        "materials": [{"name": "brass"}],
        "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3",
                       "min": [0, 0, 0], "max": [1, 1, 0]}],
        "bufferViews": [{"buffer": 0, "byteLength": 36}],
        "buffers": [{"byteLength": 36, "uri": TRIANGLE}],
        **more,
    }
    for target, extras in ((gltf["nodes"][0], nodes), (gltf["materials"][0], materials)):
        if extras is not ...:
            target["extras"] = {"chandelier": extras, "made_by": "someone else"}
    return gltf


class ShadowExtras(unittest.TestCase):
    def setUp(self):
        jsonschema.Draft202012Validator.check_schema(SCHEMA)
        self.validator = jsonschema.Draft202012Validator(SCHEMA)
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def bake(self, gltf, *options):
        path = self.folder / "scene.gltf"
        path.write_text(json.dumps(gltf))
        command = [BAKE, "-q", path, "-o", self.folder / "out.chandelier", *options]
        return subprocess.run(command, capture_output=True, text=True)

    def inspect(self, *options):
        done = subprocess.run([INSPECT, self.folder / "out.chandelier", *options], capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, done.stderr)
        return done.stdout

    def test_both_accept_what_is_good_and_the_pack_says_it(self):
        for extras in GOOD + SCHEMA["examples"]:
            self.assertTrue(self.validator.is_valid(extras), extras)
            for on_node in (False, True):
                with self.subTest(extras, on_node=on_node):
                    result = self.bake(scene(nodes=extras) if on_node else scene(materials=extras), "--cache",
                                       self.folder / "cache", "--json", self.folder / "report.json")
                    self.assertEqual(result.returncode, 0)
                    self.assertRegex(result.stderr, r"\Achandelier-bake: warning: scene: lights: there are none[^\n]*\n\Z")
                    shadowless = extras.get("shadow") is False
                    report = json.loads(self.inspect("--json"))
                    self.assertEqual(report["shadowless_instances"], int(shadowless and on_node))
                    self.assertEqual(report["materials"][0]["shadowless"], shadowless and not on_node)
                    self.assertEqual(report["triangles"], {"stored": 1, "drawn": 1, "shadowless": int(shadowless)})
                    self.assertEqual("1 of the drawn triangles (100.0 %)" in self.inspect(), shadowless)
                    passes = json.loads((self.folder / "report.json").read_text())["passes"]
                    instances = next(entry for entry in passes if entry["name"] == "instances")
                    self.assertEqual(instances["counts"]["shadowless_batches"], int(shadowless))

    def test_both_refuse_what_is_bad_and_name_the_key(self):
        for number, (extras, key) in enumerate(BAD):
            with self.subTest(extras):
                errors = list(self.validator.iter_errors(extras))
                self.assertEqual([list(error.absolute_path) for error in errors], [[key] if key else []])
                on_node = number % 2 == 0
                result = self.bake(scene(nodes=extras) if on_node else scene(materials=extras))
                self.assertEqual((result.returncode, result.stderr.count("\n")), (1, 1))
                place = "node 0 'shade'" if on_node else "material 0 'brass'"
                self.assertIn(f"{place}, extras.chandelier" + (f", {key}: " if key else ": "), result.stderr)

    def test_a_key_that_the_schema_does_not_list_is_a_warning_with_its_name(self):
        for extras in ({"shadows": False}, {"Shadow": False}, {"priority": 3}):
            self.assertTrue(self.validator.is_valid(extras))
            for both in ({"nodes": extras}, {"materials": extras}):
                result = self.bake(scene(**both))
                self.assertEqual(result.returncode, 0)
                self.assertEqual(result.stderr.count("unknown key is ignored (%s)" % next(iter(extras))), 1)

    def test_a_node_with_a_light_and_a_mesh_says_it_of_both(self):
        gltf = scene(nodes={"shadow": False, "priority": 3}, extensionsUsed=["KHR_lights_punctual"],
                     extensions={"KHR_lights_punctual": {"lights": [{"type": "point"}]}})
        gltf["nodes"][0]["extensions"] = {"KHR_lights_punctual": {"light": 0}}
        self.assertEqual(self.bake(gltf).returncode, 0)
        report = json.loads(self.inspect("--json"))
        self.assertEqual((report["shadowless_instances"], report["lights"][0]["shadowless"]), (1, True))
        self.assertEqual(report["lights"][0]["priority"], 3)

    def test_a_group_says_nothing_of_its_children(self):
        gltf = scene()
        gltf["nodes"].append({"name": "lamp", "children": [0], "extras": {"chandelier": {"shadow": False}}})
        result = self.bake(gltf)
        self.assertEqual(result.returncode, 0)
        self.assertIn("node 1 'lamp': extras.chandelier.shadow of a node without mesh and light is ignored: it "
                      "does not apply to children", result.stderr)
        self.assertEqual(json.loads(self.inspect("--json"))["shadowless_instances"], 0)

    def test_each_copy_of_a_node_throws_none(self):
        gltf = scene(nodes={"shadow": False}, extensionsUsed=["EXT_mesh_gpu_instancing"])
        gltf["nodes"][0]["extensions"] = {"EXT_mesh_gpu_instancing": {"attributes": {"TRANSLATION": 0}}}
        self.assertEqual(self.bake(gltf).returncode, 0)
        self.assertEqual(json.loads(self.inspect("--json"))["shadowless_instances"], 3)


if __name__ == "__main__":
    unittest.main()
