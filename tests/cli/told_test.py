# SPDX-License-Identifier: Apache-2.0
"""What chandelier-bake says of odd things in a file, and what it makes of them."""
import json
import unittest

from bake_test import BakeTest, png, rig, textured, triangle


class Told(BakeTest):
    def lit(self, **light):
        gltf = rig()
        gltf["extensions"]["KHR_lights_punctual"]["lights"][0].update(light)
        return self.write("rig.gltf", gltf)

    def test_a_pack_without_triangles_or_lights(self):
        scene, lamps = self.write("scene.gltf", triangle()), self.lit()
        for inputs, lacks in (([scene], ["lights"]), ([lamps], ["triangles"]), ([scene, lamps], []),
                              ([self.write("empty.gltf", {"asset": {"version": "2.0"}})], ["triangles", "lights"])):
            with self.subTest(inputs=inputs):
                done = self.run_bake_as_it_is("-q", *inputs, "-o", self.pack)
                self.assertEqual(done.returncode, 0, done.stderr)
                self.assertEqual([line.split(": ")[3] for line in done.stderr.splitlines()], lacks)
                self.assertEqual("--headlight or --ambient" in done.stderr, "lights" in lacks)

    def test_a_range_of_zero_is_none(self):
        self.assertEqual(self.warnings_of(self.lit(range=0)), [
            f"{self.folder}/rig.gltf: light 0: a light's range of 0 is taken as none: it ends where --range-threshold says"])
        self.assertEqual(self.inspect()["lights"][0]["range_source"], "derived")
        zero = self.inspect()["lights"][0]["range_m"]
        gltf = rig()
        del gltf["extensions"]["KHR_lights_punctual"]["lights"][0]["range"]
        self.bake(self.write("rig.gltf", gltf))
        self.assertEqual(self.inspect()["lights"][0]["range_m"], zero)
        self.assertEqual(self.warnings_of(self.lit(range=0, type="directional")), [])

    def test_a_range_of_zero_in_extras_takes_the_lights_own_away(self):
        said = self.warnings_of(self.lit(range=7, extras={"chandelier": {"range_m": 0}}))
        self.assertEqual(len(said), 1)
        self.assertEqual(self.inspect()["lights"][0]["range_source"], "derived")

    def test_colours_above_one(self):
        said = self.warnings_of(self.lit(color=[255, 200, 180]))
        self.assertEqual(said, [f"{self.folder}/rig.gltf: light 0: a light's colour is above 1, where glTF's end: it is "
                                "that much brighter"])
        self.assertEqual(self.warnings_of(self.lit(color=[1, 0.5, 0])), [])
        gltf = triangle()
        gltf["materials"] = [{"emissiveFactor": [0, 12, 0]}]
        said = self.warnings_of(self.write("a.gltf", gltf))
        self.assertEqual(len(said), 1)
        self.assertIn("material 0: breaks glTF: its emissiveFactor is above 1", said[0])

    def test_a_light_of_many_nodes_once(self):
        gltf = json.loads(self.lit(range=0, color=[2, 2, 2]).read_text())
        gltf["nodes"] += [gltf["nodes"][0]] * 49
        gltf["scenes"] = [{"nodes": list(range(len(gltf["nodes"])))}]
        self.assertEqual([line.split(": ")[1] for line in self.warnings_of(self.write("many.gltf", gltf))], ["light 0", "light 0"])

    def test_misspelt_keys(self):
        for spoil, says in ((lambda g: g.update({"node": g.pop("nodes")}), "glTF: unknown key is ignored (node, is it nodes?)"),
                            (lambda g: g["nodes"][0].update({"Translaton": [0, 1, 0]}),
                             "(node 0 'triangle': Translaton, is it translation?)"),
                            (lambda g: g["meshes"][0]["primitives"][0].update({"materail": 0}), "(mesh 0: materail, is it material?)"),
                            (lambda g: g.update({"materials": [{"pbrMetallicRoughness": {"baseColourFactor": [1, 0, 0, 1]}}]}),
                             "(material 0: baseColourFactor, is it baseColorFactor?)"),
                            (lambda g: g["asset"].update({"made by": "hand"}), "(made by)"),
                            (lambda g: g.update({"": 1}), "(an empty name)")):
            with self.subTest(says=says):
                gltf = triangle()
                spoil(gltf)
                said = self.warnings_of(self.write("a.gltf", gltf))
                self.assertEqual(len(said), 1, said)
                self.assertIn(says, said[0])
        gltf = rig()
        gltf["extensions"]["KHR_lights_punctual"]["lights"][0]["colour"] = [1, 0, 0]
        said = self.warnings_of(self.write("a.gltf", gltf))
        self.assertIn("(light 0: colour, is it color?)", said[0])

    def test_keys_that_are_nobodys_business(self):
        gltf = triangle()
        gltf["extras"] = gltf["nodes"][0]["extras"] = {"nodse": 1}
        gltf["nodes"][0]["extensions"] = {"EXT_other": {"mesch": 1}}
        gltf["extensionsUsed"] = ["EXT_other"]
        self.assertEqual(len(self.warnings_of(self.write("a.gltf", gltf))), 1)  # of the extension

    def test_a_backslash_in_a_uri(self):
        (self.folder / "tex").mkdir()
        self.write("tex/a.png", png(2, 2, b"\0" * 18))
        self.write("a.png", png(2, 2, b"\0" * 18))
        for uri in ("tex\\a.png", "tex%5Ca.png", ".\\tex\\..\\tex\\a.png"):
            with self.subTest(uri=uri):
                said = self.warnings_of(self.write("a.gltf", textured(uri)), "--depfile", "a.d")
                self.assertEqual(len(said), 1, said)
                self.assertIn(": image 0 'wall' (", said[0])
                self.assertIn("breaks glTF: a backslash in its URI is taken as /", said[0])
                self.assertIn("tex/a.png", (self.folder / "a.d").read_text().replace("tex/../", ""))
        self.write("tex\\a.png", png(2, 2, b"\0" * 18))  # a file of that very name comes first
        self.assertEqual(self.warnings_of(self.write("a.gltf", textured("tex\\a.png"))), [])
        self.assert_refused(self.write("a.gltf", textured("gone\\a.png")), says="no such file")
        self.assert_refused(self.write("a.gltf", textured(f"\\{self.folder}/a.png")), says="URI is not relative to the file")
        self.assert_refused(self.write("a.gltf", textured(f"%5C{self.folder}/a.png")), says="URI is not relative to the file")
        self.assert_refused(self.write("a.gltf", textured("C:\\tex\\a.png")), says="URI is not relative to the file")

    def test_hidden_nodes(self):
        gltf = triangle()
        gltf["extensionsUsed"] = gltf["extensionsRequired"] = ["KHR_node_visibility"]
        gltf["nodes"].append({"mesh": 0, "name": "ghost", "extensions": {"KHR_node_visibility": {"visible": False}}})
        said = self.warnings_of(self.write("a.gltf", gltf), "--json", "report.json")
        self.assertEqual(said, [f"{self.folder}/a.gltf: nodes: meshes and lights hidden by KHR_node_visibility are left out "
                                "(node 1 'ghost')"])
        self.assertEqual(self.inspect()["instances"], 1)
        report = json.loads((self.folder / "report.json").read_text())
        self.assertEqual(report["passes"][0]["counts"]["hidden_nodes"], 1)


class Scenes(BakeTest):
    """--scene"""

    def setUp(self):
        super().setUp()
        gltf = triangle()
        gltf["nodes"] += [{"mesh": 0, "translation": [0, 5, 0]}, {"mesh": 0, "translation": [0, -5, 0]}]
        gltf["scenes"] = [{"nodes": [0]}, {"name": "upper floor", "nodes": [1]}, {"name": "0", "nodes": [2]}]
        self.scene = self.write("house.gltf", gltf)

    def floor(self, *arguments):
        """How high the lowest point of what is baked lies."""
        self.bake(self.scene, *arguments)
        return self.inspect()["bounds_min_ws"][1]

    def test_the_others_are_named(self):
        said = self.warnings_of(self.scene)
        self.assertEqual(said, [f"{self.scene}: scene 0: is the only scene that is baked; --scene NAME or NUMBER takes "
                                "another. Left out (scene 1 'upper floor', scene 2 '0')"])

    def test_one_is_taken_by_name_or_number(self):
        self.assertEqual(self.floor("--scene", "upper floor"), 5)
        self.assertEqual(self.floor("--scene", "1"), 5)
        self.assertEqual(self.floor("--scene", "0"), -5)  # a name comes first

    def test_one_that_is_not_there(self):
        for name in ("3", "-1", "1.0", "Upper floor", "1 "):
            self.assert_refused(self.scene, "--scene", name,
                                says=f"house.gltf: --scene: there is no such scene; the scenes are scene 0, scene 1 'upper floor', scene 2 '0' ({name})")
        self.assert_refused(self.write("a.gltf", triangle()), "--scene", "7", says="--scene: no input has such a scene (7)")

    def test_an_input_with_one_scene_stays_as_it_is(self):
        self.bake(self.scene, self.write("rig.gltf", rig()), "--scene", "upper floor")
        self.assertEqual(len(self.inspect()["lights"]), 1)


if __name__ == "__main__":
    unittest.main()
