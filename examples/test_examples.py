# SPDX-License-Identifier: Apache-2.0
"""Runs each scene script as a user would and checks the file that it wrote."""

import json
import os
import struct
import subprocess
import sys
import tempfile
import unittest

import numpy as np

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(0, HERE)
from gltf_reader import Scene, spheres_in_view  # noqa: E402
from light_selection import light_clusters  # noqa: E402
from triangle_distance import nearest_distance  # noqa: E402

DATA = os.environ.get("CHANDELIER_DATA_DIR") or os.path.join(HERE, "..", "..", "shared", "data")
FOLDER = tempfile.TemporaryDirectory()
written = {}


def run(script, output):
    return subprocess.run([sys.executable, "-B", os.path.join(HERE, script + ".py"), "-o", output], capture_output=True, text=True)


def scene(name):
    """The scene as read back, made once for all tests."""
    if name not in written:
        path = os.path.join(FOLDER.name, name + ".glb")
        result = run(name, path)
        assert result.returncode == 0, result.stderr
        written[name] = (path, Scene(path))
    return written[name]


def cluster_counts(made, camera_name, d_inits):
    """Selection among the lights in view, in the order in which the file's nodes bring them."""
    matrix, camera = made.cameras[camera_name]
    positions = np.array([position for _, position, _ in made.lights])
    ranges = np.array([light["range"] for _, _, light in made.lights])
    visible = spheres_in_view(positions, ranges, matrix, camera)
    counts = [len(light_clusters(positions[visible], ranges[visible], matrix[:3, 3], d)) for d in d_inits]
    return int(visible.sum()), counts


class Scenes(unittest.TestCase):
    def check(self, name, lights, triangles, free_m):
        path, made = scene(name)
        with open(path, "rb") as file:
            first = file.read()
        self.assertEqual(struct.unpack_from("<4sII", first), (b"glTF", 2, len(first)))
        again = path + ".again"
        self.assertEqual(run(name, again).returncode, 0)
        with open(again, "rb") as file:
            self.assertEqual(file.read(), first, "the same script must write the same bytes")
        self.assertEqual(len(made.lights), lights)
        self.assertEqual(len({light_name for light_name, _, _ in made.lights}), lights)
        self.assertTrue(triangles[0] <= len(made.triangles) <= triangles[1], len(made.triangles))
        face = np.cross(made.triangles[:, 1] - made.triangles[:, 0], made.triangles[:, 2] - made.triangles[:, 0])
        self.assertGreater(np.linalg.norm(face, axis=1).min(), 0, "a triangle without area")
        agreement = np.einsum("ij,ikj->ik", face, made.normals)
        self.assertGreater(agreement.min(), 0, "a normal that points into its triangle's back")
        for light_name, position, _ in made.lights:
            self.assertGreater(nearest_distance(position, made.triangles), free_m, light_name)
        for camera_name, (matrix, camera) in made.cameras.items():
            self.assertGreater(nearest_distance(matrix[:3, 3], made.triangles), camera["perspective"]["znear"], camera_name)

    def test_atrium_file(self):
        self.check("atrium", 80, (20_000, 80_000), 0.03)

    def test_atrium_clusters_are_the_papers(self):
        _, made = scene("atrium")
        self.assertTrue(all(light["range"] == 7 for _, _, light in made.lights))
        self.assertEqual(cluster_counts(made, "hall", (0.1, 0.3, 0.5, 1.6)), (80, [80, 44, 26, 10]))

    def test_cornell_file(self):
        self.check("cornell", 32, (2_000, 20_000), 0.04)

    def test_cornell_clusters_are_the_papers(self):
        _, made = scene("cornell")
        self.assertEqual(len({light["range"] for _, _, light in made.lights}), 32)
        self.assertEqual(cluster_counts(made, "front", (0.3, 0.4, 0.5, 0.6)), (32, [13, 6, 5, 4]))

    def test_restaurant_file(self):
        self.check("restaurant", 14, (10_000, 60_000), 0.01)

    def test_restaurant_clusters_are_the_papers(self):
        _, made = scene("restaurant")
        self.assertTrue(all(light["range"] == 2 for _, _, light in made.lights))
        self.assertEqual(cluster_counts(made, "table", (0.2, 0.3, 0.4, 0.5)), (14, [12, 9, 8, 7]))

    def test_rooms_file(self):
        self.check("rooms", 32, (15_000, 60_000), 0.02)

    def test_rooms_lamps_hang_nearer_to_the_next_room_s_than_to_each_other(self):
        _, made = scene("rooms")

        def sconce(name):  # "Bulb, room 0 0 right 0 back"
            return name.rsplit(" ", 1)[0]

        def room(name):
            return name.split()[2:4]

        for name, position, _ in made.lights:
            others = [(np.linalg.norm(position - p), n) for n, p, _ in made.lights if sconce(n) != sconce(name)]
            nearest, beside = min(others)
            self.assertNotEqual(room(name), room(beside), name)
            self.assertLess(nearest, 0.45)
            self.assertGreater(min(d for d, n in others if room(n) == room(name)), 1.2, name)

    def test_unwritable_output_is_one_line(self):
        result = run("cornell", os.path.join(FOLDER.name, "no", "such", "folder.glb"))
        self.assertEqual(result.returncode, 1)
        self.assertEqual(result.stderr.count("\n"), 1)
        self.assertIn("folder.glb: No such file", result.stderr)

    def test_a_failed_write_leaves_nothing_behind(self):
        with tempfile.TemporaryDirectory() as folder:
            output = os.path.join(folder, "is_a_folder.glb")
            os.mkdir(output)
            self.assertEqual(run("cornell", output).returncode, 1)
            self.assertEqual(os.listdir(folder), ["is_a_folder.glb"])


class InData(unittest.TestCase):
    """What the scripts and cameras say about scenes that are not in this repository."""

    def read(self, name):
        path = os.path.join(DATA, "scenes", name)
        if not os.path.exists(path):
            self.skipTest(f"{path} is absent")
        return Scene(path)

    def test_sponza_rig_hangs_free(self):
        sponza = self.read("crytek_sponza/crytek_sponza.gltf")
        _, rig = scene("sponza_rig")
        self.assertEqual(len(rig.lights), 80)
        self.assertEqual(len(rig.triangles), 0)
        for name, position, light in rig.lights:
            self.assertEqual(light["range"], 7)
            self.assertGreater(nearest_distance(position, sponza.triangles), 0.15, name)
        for name, (matrix, _) in rig.cameras.items():
            self.assertGreater(nearest_distance(matrix[:3, 3], sponza.triangles), 0.1, name)

    def test_night_cameras_stand_free(self):
        with open(os.path.join(HERE, "night_cameras.json"), encoding="utf-8") as file:
            cameras = json.load(file)
        for path, views in cameras.items():
            night = self.read(path)
            for name, text in views.items():
                numbers = [float(number) for number in text.split(",")]
                self.assertEqual(len(numbers), 7)
                self.assertGreater(nearest_distance(numbers[:3], night.triangles), 0.15, f"{path} {name}")


if __name__ == "__main__":
    unittest.main()
