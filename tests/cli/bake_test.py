# SPDX-License-Identifier: Apache-2.0
# Runs chandelier-bake and chandelier-inspect as a user would, over good and bad inputs.
import base64
import json
import os
import pathlib
import struct
import subprocess
import sys
import tempfile
import unittest
import zlib

from bake_tool import without_emptiness, without_slow_passes

BAKE = os.environ["CHANDELIER_BAKE"]
INSPECT = os.environ["CHANDELIER_INSPECT"]


def triangle():
    """A glTF with one triangle, as a dict."""
    data = struct.pack("<9f3H", 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 1, 2)
    return {
        "asset": {"version": "2.0"},
        "nodes": [{"mesh": 0, "name": "triangle"}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "type": "VEC3", "count": 3, "min": [0, 0, 0], "max": [1, 1, 0]},
            {"bufferView": 1, "componentType": 5123, "type": "SCALAR", "count": 3},
        ],
        "bufferViews": [
            {"buffer": 0, "byteLength": 36},
            {"buffer": 0, "byteOffset": 36, "byteLength": 6},
        ],
        "buffers": [{"byteLength": len(data), "uri": "data:application/octet-stream;base64," + base64.b64encode(data).decode()}],
    }


def textured(image):
    """The triangle with an image."""
    gltf = triangle()
    gltf["images"] = [{"uri": image, "name": "wall"}]
    gltf["textures"] = [{"source": 0}]
    gltf["materials"] = [{"emissiveTexture": {"index": 0}}]
    gltf["meshes"][0]["primitives"][0]["material"] = 0
    return gltf


def png(width, height, rows, depth=8, color=6, packed=None):
    """A PNG whose checksums are right; `rows`: each a filter byte and its texels."""
    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
    header = struct.pack(">IIBBBBB", width, height, depth, color, 0, 0, 0)
    data = zlib.compress(rows) if packed is None else packed
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", data) + chunk(b"IEND", b"")


def rig():
    """A glTF with one lamp and nothing else."""
    light = {"type": "point", "range": 7, "intensity": 30}
    return {
        "asset": {"version": "2.0"},
        "extensionsUsed": ["KHR_lights_punctual"],
        "extensions": {"KHR_lights_punctual": {"lights": [light]}},
        "nodes": [{"name": "lamp", "translation": [0.25, 0.25, 1], "extensions": {"KHR_lights_punctual": {"light": 0}}}],
    }


class BakeTest(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        self.pack = self.folder / "out.chandelier"

    def write(self, name, gltf):
        path = self.folder / name
        path.write_bytes(gltf if isinstance(gltf, bytes) else json.dumps(gltf).encode())
        return path

    def run_bake_as_it_is(self, *arguments):
        return without_slow_passes(
            subprocess.run([BAKE, *map(str, arguments)], capture_output=True, text=True, cwd=self.folder))

    def run_bake(self, *arguments):
        return without_emptiness(self.run_bake_as_it_is(*arguments))

    def bake(self, *arguments):
        """Runs a bake that must work."""
        done = self.run_bake(*arguments, "-o", self.pack)
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        return done

    def warnings_of(self, *arguments):
        """Runs a bake that must work; its warnings, without what each begins with."""
        done = self.run_bake(*arguments, "-o", self.pack)
        self.assertEqual(done.returncode, 0, done.stderr)
        start = "chandelier-bake: warning: "
        for line in done.stderr.splitlines():
            self.assertTrue(line.startswith(start), line)
        return [line[len(start):] for line in done.stderr.splitlines()]

    def inspect(self):
        done = subprocess.run([INSPECT, self.pack, "--json"], capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, done.stderr)
        return json.loads(done.stdout)

    def assert_refused(self, *arguments, says, output=None):
        """The bake fails with one line that holds `says`, and the folder is as it was."""
        before = {path: path.read_bytes() for path in self.folder.rglob("*") if path.is_file()}
        done = self.run_bake(*arguments, "-o", output or self.pack)
        self.assertEqual(done.returncode, 1, done.stderr)
        self.assertEqual(done.stdout, "")
        lines = done.stderr.splitlines()
        self.assertEqual(len(lines), 1, done.stderr)
        self.assertTrue(lines[0].startswith("chandelier-bake: error: "), lines[0])
        self.assertIn(says, lines[0])
        after = {path: path.read_bytes() for path in self.folder.rglob("*") if path.is_file()}
        self.assertEqual(before, after)


class Good(BakeTest):
    def test_a_scene_becomes_a_pack_and_a_summary(self):
        done = self.bake(self.write("scene.gltf", triangle()))
        self.assertRegex(done.stdout, r"^1 triangles \(1 instanced\), 1 batches of 1.0 on average, 0 images, 0 lights, "
                                      r"\d+ bytes, [\d.]+ s\n$")
        self.assertIn(f", {self.pack.stat().st_size} bytes,", done.stdout)
        self.assertEqual([path.name for path in self.folder.iterdir() if path.name != "scene.gltf"], ["out.chandelier"])
        self.inspect()

    def test_several_inputs_merge(self):
        done = self.bake(self.write("scene.gltf", triangle()), self.write("rig.gltf", rig()))
        self.assertIn("1 triangles", done.stdout)
        self.assertIn("1 lights", done.stdout)

    def test_the_same_input_gives_the_same_bytes(self):
        scene = self.write("scene.gltf", triangle())
        self.bake(scene)
        first = self.pack.read_bytes()
        self.bake(scene)
        self.assertEqual(first, self.pack.read_bytes())

    def test_quiet_says_nothing(self):
        self.assertEqual(self.bake("--quiet", self.write("scene.gltf", triangle())).stdout, "")

    def test_a_warning_is_a_line_and_no_failure(self):
        gltf = triangle()
        gltf["extensionsUsed"] = ["KHR_materials_ior"]
        done = self.run_bake("-q", self.write("scene.gltf", gltf), "-o", self.pack)
        self.assertEqual(done.returncode, 0)
        self.assertRegex(done.stderr, r"^chandelier-bake: warning: .*scene.gltf: .*KHR_materials_ior.*\n$")

    def test_the_range_threshold_reaches_the_pack(self):
        gltf = rig()
        del gltf["extensions"]["KHR_lights_punctual"]["lights"][0]["range"]
        self.bake(self.write("rig.gltf", gltf), "--range-threshold", "0.3")  # sqrt(30 cd / 0.3 lx) = 10 m
        light = self.inspect()["lights"][0]
        self.assertAlmostEqual(light["range_m"], 10, places=5)
        self.assertEqual(light["range_source"], "derived")

    def test_glass_throws_no_shadow_unless_asked_for(self):
        gltf = triangle()
        gltf["extensionsRequired"] = gltf["extensionsUsed"] = ["KHR_materials_transmission"]
        gltf["materials"] = [{"name": "pane", "pbrMetallicRoughness": {"metallicFactor": 0},
                              "extensions": {"KHR_materials_transmission": {"transmissionFactor": 0.75}}}]
        gltf["meshes"][0]["primitives"][0]["material"] = 0
        scene = self.write("scene.gltf", gltf)
        done = self.run_bake("-q", scene, "-o", self.pack)
        self.assertEqual(done.stderr, "chandelier-bake: warning: scene: materials: light passes through them, so they "
                                      "cast no shadow (--glass-shadows gives them one) (pane)\n")
        self.assertTrue(self.inspect()["materials"][0]["shadowless"])
        report = self.folder / "report.json"
        self.bake("-q", scene, "--glass-shadows", "--json", report)
        self.assertFalse(self.inspect()["materials"][0]["shadowless"])
        self.assertEqual(self.inspect()["materials"][0]["transmission_factor"], 0.75)
        self.assertEqual(json.loads(report.read_text())["settings"]["glass-shadows"], "true")
        self.assertIn("--glass-shadows", self.run_bake("--help").stdout)

    def test_help_names_defaults_and_examples(self):
        done = self.run_bake("--help")
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        for text in ("--batch-triangles", "100", "--range-threshold", "0.05", "--scene", "--strict", "--quiet", "Examples:"):
            self.assertIn(text, done.stdout)


    def test_pngs_of_every_kind_bake_without_a_word(self):
        for name, data in {
                "plain": png(2, 2, b"\0" * 18), "two bits": png(5, 2, b"\0" * 6, depth=2, color=0),
                "too much data": png(2, 2, b"\0" * 50), "rubbish after the data": png(
                    2, 2, b"", packed=zlib.compress(b"\0" * 18) + b"rubbish")}.items():
            with self.subTest(name=name):
                self.write("a.png", data)
                self.bake(self.write("a.gltf", textured("a.png")))


class Usage(BakeTest):
    def test_wrong_usage_exits_2_with_one_line(self):
        scene = self.write("scene.gltf", triangle())
        for arguments in ([], [scene], ["-o", self.pack], [scene, "-o", self.pack, "--no-such-option"],
                          [scene, "-o", self.pack, "--batch-triangles", "513"],
                          [scene, "-o", self.pack, "--batch-triangles", "0"],
                          [scene, "-o", self.pack, "--batch-triangles", "many"],
                          [scene, "-o", self.pack, "--batch-triangles", "99"],
                          [scene, "-o", self.pack, "--voxels", "1025"],
                          [scene, "-o", self.pack, "--voxels", "32,32"],
                          [scene, "-o", self.pack, "--voxels", "0,1,1"],
                          [scene, "-o", self.pack, "--voxels", "1024,1024,1024"],
                          [scene, "-o", self.pack, "--voxel-large", "both"],
                          [scene, "-o", self.pack, "--range-threshold", "0"],
                          [scene, "-o", self.pack, "--range-threshold", "-1"],
                          [scene, "-o", self.pack, "--range-threshold", "nan"],
                          [scene, "-o", self.pack, "--scene", ""]):
            with self.subTest(arguments=arguments):
                done = self.run_bake(*arguments)
                self.assertEqual(done.returncode, 2, done.stderr)
                self.assertEqual(len(done.stderr.splitlines()), 1, done.stderr)
                self.assertFalse(self.pack.exists())


class Bad(BakeTest):
    def test_a_missing_file(self):
        self.assert_refused(self.folder / "gone.gltf", says="gone.gltf: no such file")

    def test_a_folder(self):
        self.assert_refused(self.folder, says="is not a file")

    def test_not_a_gltf(self):
        self.assert_refused(self.write("a.gltf", b"\x7fELF\0\0"), says="a.gltf: is not a glTF")

    def test_a_truncated_glb(self):
        text = json.dumps({"asset": {"version": "2.0"}}).encode()
        text += b" " * (-len(text) % 4)
        whole = struct.pack("<4sIIII", b"glTF", 2, 20 + len(text), len(text), 0x4E4F534A) + text
        self.bake(self.write("a.glb", whole))
        self.assert_refused(self.write("a.glb", whole[:-4]), says="a.glb: truncated GLB")

    def test_a_short_buffer(self):
        gltf = triangle()
        gltf["buffers"][0]["uri"] = "data:application/octet-stream;base64,AAAA"
        self.assert_refused(self.write("a.gltf", gltf), says="buffer 0: is shorter than its byteLength 42 (3 bytes)")

    def test_a_missing_buffer(self):
        gltf = triangle()
        gltf["buffers"][0]["uri"] = "gone.bin"
        self.assert_refused(self.write("a.gltf", gltf), says="buffer 0: no such file")

    def test_an_index_out_of_range(self):
        gltf = triangle()
        data = struct.pack("<9f3H", 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 1, 700)
        gltf["buffers"][0]["uri"] = "data:application/octet-stream;base64," + base64.b64encode(data).decode()
        self.assert_refused(self.write("a.gltf", gltf), says="mesh 0, primitive 0, indices: index is out of range")

    def test_a_position_that_is_not_a_number(self):
        gltf = triangle()
        data = struct.pack("<9f3H", 0, 0, 0, float("nan"), 0, 0, 0, 1, 0, 0, 1, 2)
        gltf["buffers"][0]["uri"] = "data:application/octet-stream;base64," + base64.b64encode(data).decode()
        self.assert_refused(self.write("a.gltf", gltf),
                            says="mesh 0, primitive 0, attribute POSITION: value is not finite")

    def test_an_unknown_required_extension(self):
        gltf = triangle()
        gltf["extensionsRequired"] = ["EXT_unheard_of"]
        self.assert_refused(self.write("a.gltf", gltf), says="EXT_unheard_of")

    def test_an_image_that_cannot_be_decoded(self):
        gltf = textured("a.png")
        for data in (b"no picture", b"\x89PNG\r\n\x1a\n", b"\xff\xd8\xff\xe0", b"\xff\xd8\xff" + b"\0" * 200):
            with self.subTest(data=data):
                self.write("a.png", data)
                self.assert_refused(self.write("a.gltf", gltf), says="a.gltf: image 0 'wall' (a.png): ")

    def test_the_second_of_two_inputs(self):
        self.assert_refused(self.write("a.gltf", triangle()), self.write("b.gltf", b"{"), says="b.gltf: is not a glTF")

    def test_an_older_pack_survives(self):
        self.bake(self.write("a.gltf", triangle()))
        self.assert_refused(self.write("b.gltf", b"{"), says="b.gltf")  # compares the folder's bytes

    def test_an_output_that_cannot_be_written(self):
        scene = self.write("a.gltf", triangle())
        bad = self.write("bad.gltf", b"{")  # the output is looked at first: a bake may take minutes
        self.assert_refused(bad, says="there is no such folder", output=self.folder / "no/such/out.chandelier")
        self.assert_refused(scene, says="no/such/folder", output=self.folder / "no/such/folder/out.chandelier")
        self.assert_refused(scene, says=str(self.folder), output=self.folder)

    def test_an_output_that_is_an_input(self):
        scene = self.write("a.gltf", triangle())
        self.assert_refused(scene, says="the output is one of the inputs", output=scene)

    def test_an_output_that_is_a_buffer_or_an_image_of_an_input(self):
        gltf = textured("a.png")
        buffer = self.write("a.bin", base64.b64decode(gltf["buffers"][0]["uri"].partition(",")[2]))
        gltf["buffers"][0]["uri"] = "a.bin"
        image = self.write("a.png", png(2, 2, b"\0" * 18))
        scene = self.write("a.gltf", gltf)
        self.bake(scene)
        for output in (buffer, image, self.folder / "nothing" / ".." / "a.bin"):
            with self.subTest(output=output):
                (self.folder / "nothing").mkdir(exist_ok=True)
                self.assert_refused(scene, says="the output is one of the inputs", output=output)

    def test_pngs_that_the_decoder_would_complain_about(self):
        for name, data in {
                "too little data": png(2, 2, b"\0" * 8), "unknown filter": png(2, 2, b"\x09" * 18),
                "damaged data": png(2, 2, b"", packed=b"\x78\x9c\xff\xff\xff\xff"), "no data": png(2, 2, b"", packed=b""),
                "no palette": png(2, 2, b"\0" * 6, color=3), "bad depth": png(2, 2, b"\0" * 18, depth=3),
                "no width": png(0, 2, b"\0" * 18), "unknown colour": png(2, 2, b"\0" * 18, color=5)}.items():
            with self.subTest(name=name):
                self.write("a.png", data)
                self.assert_refused(self.write("a.gltf", textured("a.png")), says="a.gltf: image 0 'wall' (a.png): ")

    def test_pngs_that_are_slightly_damaged(self):
        """The decoder would print lines of its own. They are a warning, kept with the cache, and an error where that is strict."""
        scene = self.write("a.gltf", textured("a.png"))
        for name, data in {
                "too little data": png(2, 2, b"\0" * 10), "wrong checksum": png(2, 2, b"", packed=zlib.compress(b"\0" * 18)[:-1] + b"?"),
                "no checksum": png(2, 2, b"", packed=zlib.compress(b"\0" * 18)[:-4]), "no end": png(2, 2, b"\0" * 18)[:-12],
                "second row's filter": png(2, 2, b"\0" * 9 + b"\x09" * 9)}.items():
            with self.subTest(name=name):
                self.write("a.png", data)
                said = self.warnings_of("-q", scene, "--json", "report.json")
                self.assertEqual(len(said), 1, said)
                self.assertRegex(said[0], r"/a\.gltf: images: PNG is .*: the part that can be decoded is baked; --strict refuses such images \(image 0 'wall' \(a\.png\)\)$")
                images = next(each for each in json.loads((self.folder / "report.json").read_text())["passes"] if each["name"] == "images")
                self.assertEqual(images["counts"]["damaged"], 1)
                for _ in range(2):  # made and kept, then found
                    self.assertEqual(self.warnings_of("-q", scene, "--cache", "cache"), said)
                self.assert_refused(scene, "--strict", says="a.gltf: image 0 'wall' (a.png): PNG is ")
                self.assert_refused(scene, "--strict", "--cache", "cache", says=", which --strict refuses")

    def test_line_breaks_in_names(self):
        gltf = textured("a\nb.png")
        self.assert_refused(self.write("a.gltf", gltf), says="image 0 'wall' (a\\nb.png): no such file")
        self.assert_refused(self.folder / "a\nb.gltf", says="a\\nb.gltf: no such file")


if __name__ == "__main__":
    program = unittest.main(exit=False)
    sys.exit(not program.result.wasSuccessful())
