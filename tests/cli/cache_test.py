# SPDX-License-Identifier: Apache-2.0
"""chandelier-bake --cache: the same packs as without it, less work, and no trust in what lies in the folder."""
import concurrent.futures
import json
import os
import random
import shutil

from bake_tool import BakeTool, main, move_lights


class CacheTool(BakeTool):
    def setUp(self):
        super().setUp()
        self.cache = self.folder / "cache"
        self.scene, self.rig = self.room()

    def cached(self, *inputs, output=None):
        return self.bake(*(inputs or (self.scene, self.rig)), "--cache", self.cache, output=output)

    def entries(self, stage=""):
        return sorted(path for path in self.cache.iterdir() if path.name.startswith(stage))

    def assert_cached_alike(self, scene):
        none, _ = self.bake(scene)
        cold, _ = self.cached(scene)
        warm, report = self.cached(scene)
        self.assertTrue(none == cold == warm)
        self.assertEqual(report["cache"]["misses"], 0)


class Entries(CacheTool):
    def test_none_cold_and_warm_are_the_same(self):
        none, report = self.bake(self.scene, self.rig)
        self.assertIsNone(report["cache"])
        cold, report = self.cached()
        self.assertEqual((report["cache"]["hits"], report["warnings"]), (0, []))
        misses = report["cache"]["misses"]
        self.assertEqual(len(self.entries()), misses)
        warm, report = self.cached()
        self.assertEqual((report["cache"]["hits"], report["cache"]["misses"]), (misses, 0))
        self.assertTrue(none == cold == warm)

    def test_entries_are_packs(self):
        self.cached()
        for entry in self.entries():
            self.assert_opens(entry)

    def test_only_lights_moved(self):
        self.cached()
        move_lights(self.rig)
        warm, report = self.cached()
        self.assertEqual(report["cache"]["misses"], 0)
        none, full = self.bake(self.scene, self.rig)
        self.assertTrue(warm == none)
        ran = {each["name"]: each.get("cached", False) for each in report["passes"]}
        self.assertTrue(ran["batches"])
        self.assertFalse(ran["lights"])
        counts = lambda passes: {each["name"]: each["counts"] for each in passes}
        for name, told in counts(full["passes"]).items():
            self.assertEqual(counts(report["passes"])[name], told, f"pass {name} tells something else from the cache")

    def test_what_changes_geometry_is_a_miss(self):
        self.cached()
        geometry = len(self.entries("geometry"))
        gltf = json.loads(self.scene.read_text())
        gltf["nodes"][0]["translation"] = [0, 0.5, 0]
        self.scene.write_text(json.dumps(gltf))
        moved, _ = self.cached()
        self.assertEqual(len(self.entries("geometry")), geometry + 1)
        buffer = self.scene.parent / "room.bin"
        data = bytearray(buffer.read_bytes())
        data[2] ^= 1  # the first position's x
        buffer.write_bytes(data)
        self.cached()
        self.assertEqual(len(self.entries("geometry")), geometry + 2)
        _, report = self.bake(self.scene, self.rig, "--batch-triangles", "8", "--cache", self.cache)
        self.assertEqual(len(self.entries("geometry")), geometry + 3)

    def test_what_throws_no_shadow_is_part_of_it(self):
        glass = {"KHR_materials_transmission": {"transmissionFactor": 1}}
        pane = {"pbrMetallicRoughness": {"metallicFactor": 0}, "extensions": glass}
        self.cached()
        plain = json.loads(self.scene.read_text())
        material = next(each["material"] for each in plain["meshes"][plain["nodes"][0]["mesh"]]["primitives"])
        made = len(self.entries("geometry"))
        for change, options, new in (
            (lambda gltf: gltf["nodes"][0].update(extras={"chandelier": {"shadow": False}}), (), 1),
            (lambda gltf: gltf["materials"][material].update(extras={"chandelier": {"shadow": False}}), (), 1),
            (lambda gltf: gltf["materials"][material].update(pane), (), 1),
            (lambda gltf: gltf["materials"][material].update(pane), ("--glass-shadows",), 1),
            (lambda gltf: gltf["materials"][material].update(pane), (), 0),
        ):
            gltf = json.loads(json.dumps(plain))
            change(gltf)
            self.scene.write_text(json.dumps(gltf))
            kept, _ = self.bake(self.scene, self.rig, "--cache", self.cache, *options)
            made += new
            self.assertEqual(len(self.entries("geometry")), made)
            self.assertTrue(kept == self.bake(self.scene, self.rig, *options)[0])

    def test_what_does_not_is_none(self):
        self.cached()
        before = self.entries("geometry")
        self.bake(self.scene, self.rig, "--range-threshold", "2", "--cache", self.cache)
        shutil.move(self.scene.parent, self.folder / "elsewhere")
        self.cached(self.folder / "elsewhere" / "room.gltf")
        self.assertEqual(self.entries("geometry"), before)

    def test_a_damaged_entry_is_a_miss_with_a_warning_and_is_mended(self):
        good, _ = self.cached()
        rng = random.Random(11)
        for entry in self.entries():
            whole = entry.read_bytes()
            other = next(each for each in self.entries() if each != entry).read_bytes()
            flipped = bytearray(whole)
            flipped[rng.randrange(len(whole))] ^= 1 << rng.randrange(8)
            for name, damage in {"empty": b"", "short": whole[:len(whole) // 2], "one byte less": whole[:-1],
                                 "no pack": b"rubbish" * 100, "a bit flipped": bytes(flipped), "another's": other,
                                 "another pack": good}.items():
                with self.subTest(entry=entry.name, damage=name):
                    entry.write_bytes(damage)
                    pack, report = self.cached()
                    self.assertTrue(pack == good)
                    self.assertEqual(len(report["warnings"]), 1, report["warnings"])
                    self.assertIn(entry.name, report["warnings"][0])
                    self.assertEqual(report["cache"]["misses"], 1)
                    self.assertTrue(entry.read_bytes() == whole, "the entry is not mended")

    def test_an_entry_that_is_a_folder(self):
        good, _ = self.cached()
        for entry in self.entries():
            entry.unlink()
            entry.mkdir()
        pack, report = self.cached()
        self.assertTrue(pack == good)
        self.assertEqual(len(report["warnings"]), len(self.entries()))

    def test_many_bakers_share_one(self):
        packs = [self.folder / f"{i}.chandelier" for i in range(8)]

        def bake(pack):
            return self.run_bake(self.scene, self.rig, "-o", pack, "--cache", self.cache, "--quiet")
        with concurrent.futures.ThreadPoolExecutor(8) as pool:
            for done in pool.map(bake, packs):
                self.assertEqual((done.returncode, done.stderr), (0, ""))
        self.assertEqual(len({pack.read_bytes() for pack in packs}), 1)
        self.assertEqual([path.name for path in self.cache.iterdir() if path.name.endswith(".tmp")], [])

    def test_a_folder_that_cannot_be(self):
        (self.folder / "file").write_text("x")
        done = self.run_bake(self.scene, "-o", self.pack, "--cache", self.folder / "file")
        self.assertEqual(done.returncode, 1)
        self.assertIn("cannot make the cache's folder", done.stderr)
        self.assertFalse(self.pack.exists())

    def test_a_folder_that_cannot_be_written(self):
        if os.geteuid() == 0:
            self.skipTest("root may write anywhere")
        self.cache.mkdir(mode=0o500)
        pack, report = self.cached()
        self.assertTrue(report["warnings"])
        self.assertTrue(pack == self.bake(self.scene, self.rig)[0])


class Scenes(CacheTool):
    def test_examples(self):
        for name in ("cornell", "restaurant", "atrium"):
            with self.subTest(name=name):
                self.assert_cached_alike(self.example(name))

    def test_sponza(self):
        self.assert_cached_alike(self.data("scenes/crytek_sponza/crytek_sponza.gltf"))

    def test_animated(self):
        self.assert_cached_alike(self.data("models/khronos/Fox/glTF-Binary/Fox.glb"))


if __name__ == "__main__":
    main()
