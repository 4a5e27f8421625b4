# SPDX-License-Identifier: Apache-2.0
"""The preview is the runtime's own selection: on random scenes, baked, `chandelier-play --predict` says what the C interface
and chandelier-lights say of the same lights before any bake."""

import json
import os
import pathlib
import random
import subprocess
import sys
import tempfile
import types
import unittest

import numpy as np

SOURCE = pathlib.Path(os.environ["CHANDELIER_SOURCE"])
sys.path[:0] = [str(SOURCE / "examples"), str(SOURCE / "blender_addon" / "chandelier")]
from core import clusters  # noqa: E402
from gltf_writer import Document, look_at  # noqa: E402

SCENES, FRAMES = 6, 4  # frames of each scene
SIZE = (320, 180)
TYPES = {"point": 0, "spot": 1, "directional": 2}


def f32(value):
    """As a float holds it, so that its text is read back as the same."""
    return float(np.float32(value))


def rotation(rng):
    q = np.array([rng.gauss(0, 1) for _ in range(4)])
    return [float(part) for part in q / np.linalg.norm(q)]


class Scene:
    """Lights as columns of the C interface, and the same as glTF."""

    def __init__(self, seed):
        self.rng = rng = random.Random(seed)
        self.document = Document(f"parity {seed}")
        self.document.json["extensionsUsed"] = ["KHR_lights_punctual"]
        self.lights = self.document.json.setdefault("extensions", {}).setdefault("KHR_lights_punctual", {"lights": []})["lights"]
        self.rows = []
        self.has_radii = rng.random() < 0.3
        for number in range(rng.choice((1, 7, 30, 60))):
            self.add_light(f"lamp {number}")
        self.cameras = [self.add_camera(f"eye {number}") for number in range(2)]

    def add_light(self, name):
        rng = self.rng
        kind = rng.choices(("point", "spot", "directional"), (6, 4, 1))[0]
        row = {"name": name, "type": TYPES[kind], "position": [f32(rng.uniform(-6, 6)) for _ in range(3)],
               "intensity": 0.0 if rng.random() < 0.04 else f32(rng.uniform(0.2, 4)),
               "colour": [f32(rng.uniform(0.1, 1)) for _ in range(3)],
               "range_m": f32(rng.uniform(1, 8)) if rng.random() < 0.5 else 0.0,
               "spot_outer_rad": f32(rng.uniform(0.1, 1.5)), "flags": 0, "priority": 128, "group": -1,
               "radius_m": f32(rng.uniform(0, 0.2)) if self.has_radii else 0.0}
        light = {"type": kind, "name": name, "intensity": row["intensity"], "color": row["colour"]}
        if row["range_m"] and kind != "directional":
            light["range"] = row["range_m"]
        if kind == "spot":
            light["spot"] = {"innerConeAngle": 0.0, "outerConeAngle": row["spot_outer_rad"]}
        extras = self.extras(row)
        if extras and rng.random() < 0.5:
            light["extras"] = {"chandelier": extras}
            extras = {}
        self.lights.append(light)
        node = self.document.add_node(name, translation=row["position"], rotation=rotation(rng), light=len(self.lights) - 1)
        if extras:
            self.document.json["nodes"][node]["extras"] = {"chandelier": extras}
        self.rows.append(row)

    def extras(self, row):
        rng, extras = self.rng, {}
        if rng.random() < 0.2:
            row["flags"] |= clusters.DYNAMIC
            extras["dynamic"] = True
        if rng.random() < 0.1:
            row["flags"] |= clusters.OWN_MAP
            extras["cluster"] = False
        if rng.random() < 0.1:
            row["flags"] |= clusters.NO_SHADOW
            extras["shadow"] = False
        if row["radius_m"]:
            extras["radius_m"] = row["radius_m"]
        if rng.random() < 0.3:
            row["priority"] = extras["priority"] = rng.randrange(256)
        if rng.random() < 0.2:
            row["group"] = rng.randrange(3)
            extras["group"] = f"group {row['group']}"
        return extras

    def add_camera(self, name):
        rng = self.rng
        eye, yfov, znear = [f32(rng.uniform(-7, 7)) for _ in range(3)], f32(rng.uniform(0.4, 1.4)), f32(rng.uniform(0.05, 2))
        camera = self.document._add("cameras", {"type": "perspective", "perspective": {"yfov": yfov, "znear": znear}})
        self.document.add_node(name, translation=eye, rotation=look_at(eye, (0.3, 0.2, 0.1)), camera=camera)
        return {"name": name, "yfov_rad": yfov, "znear_m": znear}

    def table(self, directions):
        """With the directions that the bake made of the nodes' rotations; lights that it skipped have some other one."""
        column = lambda name, kind: np.array([row[name] for row in self.rows], kind)
        direction = np.array([directions.get(row["name"], (0, 0, -1)) for row in self.rows], np.float32)
        return types.SimpleNamespace(
            position=column("position", "f4"), direction=direction, type=column("type", "u1"),
            intensity=column("intensity", "f4"), colour=column("colour", "f4"), range_m=column("range_m", "f4"),
            radius_m=column("radius_m", "f4"), spot_outer_rad=column("spot_outer_rad", "f4"), flags=column("flags", "u1"), priority=column("priority", "u1"),
            group=column("group", "i4"))

    def settings(self):
        rng = self.rng
        asked = {"distance_scaling": rng.choice(clusters.SCALINGS), "dynamic_lights": rng.choice(clusters.DYNAMIC_LIGHTS),
                 "face_size_px": rng.choice((64, 256, 512)), "z_far_m": f32(rng.uniform(5, 60)),
                 "filter": rng.choice(("pcf", "pcss")), "reference_share": f32(rng.choice((0.5, 0.85, 2))),
                 "d_init_m": 0.0 if rng.random() < 0.4 else f32(2 ** rng.uniform(-2, 3))}
        budget = rng.random()
        if budget < 0.4:
            asked |= {"budget_maps": rng.randrange(1, 20)}
        elif budget < 0.6:
            asked |= {"budget_mib": rng.randrange(2, 60)}
        return clusters.Settings(**asked)


def options(settings):
    """chandelier-play's for the same."""
    out = ["--preset", "lightcluster", "--filter", settings.filter, "--distance-scaling", settings.distance_scaling,
           "--dynamic-lights", settings.dynamic_lights, "--face-size", settings.face_size_px, "--z-far", settings.z_far_m,
           "--reference-share", settings.reference_share, "--d-init", settings.d_init_m]
    if settings.budget_maps:
        out += ["--max-shadow-maps", settings.budget_maps]
    if settings.budget_mib:
        out += ["--max-shadow-bytes", settings.budget_mib]
    return out


def in_blenders_frame(table, camera):
    """Z up: another right-handed frame."""
    turned = lambda vectors: np.ascontiguousarray(np.asarray(vectors)[..., [0, 2, 1]] * np.array((1, -1, 1), np.float32))
    there = types.SimpleNamespace(**vars(table))
    there.position, there.direction = turned(table.position), turned(table.direction)
    return there, clusters.Camera(turned(camera.eye), turned(camera.forward), turned(camera.up), camera.yfov_rad,
                                  camera.znear_m, camera.size_px)


class Parity(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        self.library = clusters.Library(os.environ["CHANDELIER_PREVIEW_LIBRARY"])
        self.program = clusters.Program(os.environ["CHANDELIER_LIGHTS"])
        self.met = {"shared": 0, "out of view": 0, "over budget": 0, "grouped": 0, "reference path": 0, "dark": 0, "without shadow": 0,
                    "budget from 0": 0, "least distance kept": 0, "least distance widened": 0}

    def run_tool(self, name, *arguments):
        done = subprocess.run([os.environ[name], *map(str, arguments)], capture_output=True, text=True, check=False)
        self.assertEqual(done.returncode, 0, done.stderr)
        return done.stdout

    def bake(self, scene):
        glb, pack = self.folder / "scene.glb", self.folder / "scene.chandelier"
        glb.write_bytes(scene.document.glb())
        self.run_tool("CHANDELIER_BAKE", "-q", glb, "-o", pack)
        return pack, json.loads(self.run_tool("CHANDELIER_INSPECT", pack, "--json"))["lights"]

    def predict(self, pack, camera, settings):
        stats = self.folder / "stats.json"
        self.run_tool("CHANDELIER_PLAY", pack, "--predict", "--size", "{}x{}".format(*SIZE), "--camera", camera["name"],
                      "--stats", stats, *options(settings))
        return json.loads(stats.read_text())

    def test_random_scenes(self):
        for seed in range(SCENES):
            scene = Scene(seed)
            pack, baked = self.bake(scene)
            table = scene.table({light["name"]: light["direction_ws"] for light in baked})
            for frame in range(FRAMES):
                with self.subTest(scene=seed, frame=frame):
                    self.compare(scene, table, baked, pack, scene.rng.choice(scene.cameras), scene.settings())
        for what, count in self.met.items():
            self.assertGreater(count, 0, what)

    def compare(self, scene, table, baked, pack, named, settings):
        expected = self.predict(pack, named, settings)
        eye = expected["camera"]
        camera = clusters.Camera(eye["eye_m"], eye["forward_ws"], eye["up_ws"], named["yfov_rad"], named["znear_m"], SIZE)
        by_library = self.library.select(table, settings, camera)
        self.compare_centers(scene, baked, expected, by_library, settings)
        self.compare_bill(expected, by_library)
        self.count_budgets(settings, by_library.bill)
        self.compare_selections(by_library, self.program.select(table, settings, camera))
        turned, turned_camera = in_blenders_frame(table, camera)
        self.compare_selections(by_library, self.library.select(turned, settings, turned_camera), exact=False)

    def count_budgets(self, settings, bill):
        if settings.budget_maps or settings.budget_mib:
            self.met["budget from 0"] += bill.over_budget and settings.d_init_m == 0
            self.met["least distance kept"] += bill.d_init_m == settings.d_init_m > 0
            self.met["least distance widened"] += bill.d_init_m > settings.d_init_m > 0

    def compare_centers(self, scene, baked, expected, selection, settings):
        numbers = {row["name"]: number for number, row in enumerate(scene.rows)}
        number_of = [numbers[light["name"]] for light in baked]
        centers = np.full(len(scene.rows), -1)
        for light, center in enumerate(expected["center_of_light"]):
            if center is not None:
                centers[number_of[light]] = number_of[center]
            self.met["out of view"] += center is None
            self.met["shared"] += center not in (None, light)
        np.testing.assert_array_equal(selection.center, centers)
        ranges = np.zeros(len(scene.rows), np.float32)
        ranges[number_of] = [light["range_m"] for light in baked]
        np.testing.assert_array_equal(selection.range_m, ranges)
        lost = {scene.rows[number]["name"] for number in np.flatnonzero(selection.over_budget)}
        without = {each["light"] for each in expected["lights_without_own_map"]}
        self.assertLessEqual(lost, without)
        groups = [row["group"] for row in scene.rows]
        if selection.bill.over_budget and settings.d_init_m == 0:  # where every light but those of a group has its own
            self.assertEqual({name for name in without if groups[numbers[name]] < 0}, {n for n in lost if groups[numbers[n]] < 0})
        self.met["over budget"] += len(lost)
        self.met["dark"] += len(scene.rows) - len(baked)
        self.met["grouped"] += sum(group >= 0 and center not in (-1, number)
                                   for number, (group, center) in enumerate(zip(groups, centers)))

    def compare_bill(self, expected, selection):
        bill, counters = selection.bill, expected["counters"]
        self.assertEqual(
            (bill.lights, bill.lights_in_view, bill.shadowless_in_view, bill.shadow_maps, bill.shadow_views, bill.shadow_bytes, bill.reference_path),
            (counters["lights"], counters["lights_in_view"], counters["shadowless_in_view"], counters["shadow_maps"], counters["shadow_views"],
             counters["shadow_bytes"], counters["reference_path"] == 1))
        self.assertEqual(bill.d_init_m, expected["recipe"]["settings"]["d_init_m"])
        self.assertEqual(len(selection.clusters), counters["light_clusters"])
        self.assertEqual(int(selection.clusters["light_count"].sum()),
                         counters["lights_in_view"] - counters["shadowless_in_view"])
        self.met["without shadow"] += counters["shadowless_in_view"]
        self.met["reference path"] += bill.reference_path

    def compare_selections(self, one, other, exact=True):
        np.testing.assert_array_equal(one.center, other.center)
        np.testing.assert_array_equal(one.range_m, other.range_m)
        np.testing.assert_array_equal(one.over_budget, other.over_budget)
        for name in clusters.CLUSTER.names:
            if exact or one.clusters[name].dtype.kind == "u":
                np.testing.assert_array_equal(one.clusters[name], other.clusters[name])
            else:
                np.testing.assert_allclose(one.clusters[name], other.clusters[name], rtol=1e-5)
        if exact:
            self.assertEqual(one.bill, other.bill)
        else:
            self.assertEqual((one.bill.shadow_maps, one.bill.shadow_views), (other.bill.shadow_maps, other.bill.shadow_views))


if __name__ == "__main__":
    unittest.main()
