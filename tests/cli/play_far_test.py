# SPDX-License-Identifier: Apache-2.0
# Scenes kilometres from the origin of their file, from glTF to picture: what a person types and reads is in the file's coordinates.
import json
import os
import pathlib
import struct
import subprocess
import sys

import numpy

sys.path.insert(0, str(pathlib.Path(__file__).parents[1]))
from pictures import read_pfm
from play_tool import PlayTest, SMALL, bake, main

INSPECT = os.environ["CHANDELIER_INSPECT"]
FAR = {"1 km": (1000, 0, 0), "10 km": (-7000.5, 12, 7000), "500 km": (300000, 0, -400000.25)}


def moved(glb, place, output):
    """The same file, all of its scene below a new node at `place`."""
    data = glb.read_bytes()
    length = struct.unpack_from("<I", data, 12)[0]
    gltf = json.loads(data[20:20 + length])
    scene = gltf["scenes"][gltf.get("scene", 0)]
    gltf["nodes"].append({"name": "root", "translation": list(place), "children": scene["nodes"]})
    scene["nodes"] = [len(gltf["nodes"]) - 1]
    text = json.dumps(gltf).encode()
    text += b" " * (-len(text) % 4)
    rest = data[20 + length:]
    output.write_bytes(data[:8] + struct.pack("<III", 20 + len(text) + len(rest), len(text), 0x4E4F534A) + text + rest)
    return output


class Far(PlayTest):
    """The Cornell box near the origin, and far away."""

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.far = {}
        for name, place in FAR.items():
            cls.far[name] = cls.pack.with_name(f"{name}.chandelier")
            bake(moved(cls.pack.with_suffix(".glb"), place, cls.pack.with_name("moved.glb")), cls.far[name])

    def rmse_against_rays(self, pack):
        self.play_well(pack, "--compare", "reference,truth", "--report", "out", "--frames", 1, *SMALL)
        return json.loads((self.folder / "out/comparison.json").read_text())["rmse"]

    def test_shadows_are_as_near_to_rays_as_near_the_origin(self):
        near = self.rmse_against_rays(self.pack)
        self.assertGreater(near["linear"], 0)
        for name, pack in self.far.items():
            far = self.rmse_against_rays(pack)
            for measure in ("linear", "shown"):
                self.assertLessEqual(far[measure], 1.1 * near[measure], f"{name}, {measure}")

    def picture(self, pack, *arguments):
        self.play_well(pack, "--output", "p.pfm", "--stats", "p.json", *SMALL, *arguments)
        return read_pfm(self.folder / "p.pfm"), json.loads((self.folder / "p.json").read_text())["camera"]

    def test_cameras_are_in_the_files_coordinates(self):
        eye, target = numpy.array([0.1, 0.6, 1.4]), numpy.array([0.0, 0.45, 0.0])
        numbers = lambda place: ",".join(repr(float(x)) for x in (*(eye + place), *(target + place), 50))
        near, _ = self.picture(self.pack, "--camera", numbers((0, 0, 0)))
        near_named, near_camera = self.picture(self.pack)
        for name, pack in self.far.items():
            place = numpy.array(FAR[name])
            far, camera = self.picture(pack, "--camera", numbers(place))
            numpy.testing.assert_allclose(camera["eye_m"], eye + place, atol=1e-4)
            self.assertLess(numpy.sqrt(numpy.mean((far - near) ** 2)), 0.02 * near.mean(), name)
            far, camera = self.picture(pack)
            numpy.testing.assert_allclose(camera["eye_m"], numpy.array(near_camera["eye_m"]) + place, atol=1e-4)
            self.assertLess(numpy.sqrt(numpy.mean((far - near_named) ** 2)), 0.02 * near_named.mean(), name)

    def test_paths_are_in_the_files_coordinates(self):
        x, y, z = FAR["500 km"]
        keys = [f"{x + side},{y + 0.5},{z + 1.4},{x},{y + 0.5},{z},50" for side in (-0.2, 0.2)]
        (self.folder / "path.json").write_text(json.dumps({"keys": keys}))
        self.play_well(self.far["500 km"], "--path", "path.json", "--report", "out", "--frames", 2, *SMALL)
        last = json.loads((self.folder / "out/path.json").read_text())["last_frame"]["camera"]
        numpy.testing.assert_allclose(last["eye_m"], [x + 0.2, y + 0.5, z + 1.4], atol=1e-4)

    def inspected(self, pack, *arguments):
        return subprocess.run([INSPECT, pack, *arguments], check=True, capture_output=True, text=True).stdout

    def test_a_pack_says_where_it_lies(self):
        self.assertEqual(json.loads(self.inspected(self.pack, "--json"))["origin_m"], [0, 0, 0])
        self.assertNotIn("stored from an origin", self.inspected(self.pack))
        near = json.loads(self.inspected(self.pack, "--json"))
        for name, pack in self.far.items():
            far = json.loads(self.inspected(pack, "--json"))
            for a, b in zip(near["lights"], far["lights"]):
                numpy.testing.assert_allclose(numpy.array(b["position_ws"]) + far["origin_m"],
                                              numpy.array(a["position_ws"]) + FAR[name], atol=1e-4)
            text = self.inspected(pack)
            self.assertIn("stored from an origin at ({:.0f}, {:.0f}, {:.0f}) m".format(*far["origin_m"]), text)
            at = numpy.array(near["cameras"][0]["position_ws"]) + FAR[name]
            self.assertIn("at {:.2f}, {:.2f}, {:.2f} towards".format(*at), text)


if __name__ == "__main__":
    main()
