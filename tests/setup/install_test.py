# SPDX-License-Identifier: Apache-2.0
"""Installs Chandelier into an empty folder and builds the example project against it, with Ninja and with Make."""
import json
import os
import pathlib
import shutil
import subprocess
import tempfile
import time
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
BUILD = os.environ["CHANDELIER_BUILD"]


def run(*command, cwd=None):
    done = subprocess.run(list(map(str, command)), capture_output=True, text=True, cwd=cwd)
    return done.returncode, done.stdout + done.stderr


class Project(unittest.TestCase):
    """The example project beside an installed Chandelier."""

    @classmethod
    def setUpClass(cls):
        cls.temporary = tempfile.TemporaryDirectory()
        cls.addClassCleanup(cls.temporary.cleanup)
        cls.prefix = pathlib.Path(cls.temporary.name) / "pre fix"
        code, said = run("cmake", "--install", BUILD, "--prefix", cls.prefix)
        if code != 0:
            raise AssertionError(said)

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.project = pathlib.Path(folder.name) / "project"
        shutil.copytree(ROOT / "examples" / "cmake_project", self.project)
        self.build_folder = pathlib.Path(folder.name) / "build"
        self.pack = self.build_folder / "room.chandelier"

    def configure(self, generator):
        return run("cmake", "-G", generator, "-S", self.project, "-B", self.build_folder,
                   f"-DCMAKE_PREFIX_PATH={self.prefix}")

    def build(self, expect_success=True):
        time.sleep(0.02)  # file systems count time in steps of milliseconds
        code, said = run("cmake", "--build", self.build_folder)
        self.assertEqual(code == 0, expect_success, said)
        return said

    def assert_builds(self, generator):
        code, said = self.configure(generator)
        self.assertEqual(code, 0, said)
        self.assertIn("Baking room.chandelier", self.build())
        first = self.pack.stat().st_mtime_ns
        self.assertEqual(run(self.prefix / "bin" / "chandelier-inspect", self.pack)[0], 0)
        self.assertNotIn("Baking", self.build())
        self.assertEqual(self.pack.stat().st_mtime_ns, first)
        for name in ("tiles.png", "room.bin", "lamps.gltf"):  # the first two are known from the depfile alone
            before = self.pack.stat().st_mtime_ns
            (self.project / name).touch()
            self.assertIn("Baking room.chandelier", self.build(), f"{name} changed")
            self.assertGreater(self.pack.stat().st_mtime_ns, before)
        old = self.pack.read_bytes()
        good = (self.project / "lamps.gltf").read_text()
        (self.project / "lamps.gltf").write_text(good.replace('"intensity": 20', '"intensity": "bright"', 1))
        self.assertIn("chandelier-bake: error: ", self.build(expect_success=False))
        self.assertEqual(self.pack.read_bytes(), old)
        (self.project / "lamps.gltf").write_text(good.replace('"intensity": 20', '"intensity": 40', 1))
        self.build()
        self.assertNotEqual(self.pack.read_bytes(), old)


class Ninja(Project):
    """By itself, so that CTest shows it as skipped."""

    @unittest.skipUnless(shutil.which("ninja"), "no ninja")
    def test_ninja(self):
        self.assert_builds("Ninja")


class Installed(Project):
    def test_the_programs_run_from_there(self):
        for name in ("chandelier-bake", "chandelier-inspect", "chandelier-play"):
            code, said = run(self.prefix / "bin" / name, "--help")
            self.assertEqual(code, 0, said)

    def test_images_and_nothing_else_need_the_module(self):
        moved = self.build_folder.parent / "moved"
        shutil.copytree(self.prefix, moved)
        bake = (moved / "bin" / "chandelier-bake", self.project / "room.gltf", "-o", moved / "room.chandelier")
        self.assertEqual(run(*bake)[0], 0)
        (module,) = moved.rglob("chandelier_images.so")
        module.unlink()
        code, said = run(*bake)
        self.assertEqual((code, said.count("\n")), (1, 1), said)
        self.assertIn(f"chandelier-bake: error: {module}: cannot be loaded", said)
        code, said = run(*bake, "--textures", "none")
        self.assertEqual(code, 0, said)

    def test_schemas_and_licence_are_there(self):
        shared = self.prefix / "share"
        for path in (ROOT / "schemas").glob("*.schema.json"):
            self.assertEqual(json.loads((shared / "chandelier" / path.name).read_text()), json.loads(path.read_text()))
        self.assertEqual(len(list(shared.rglob("LICENSE"))), 1)

    def test_nothing_points_back_to_the_build(self):
        for path in self.prefix.rglob("*.cmake"):
            for folder in (BUILD, str(ROOT)):
                self.assertNotIn(folder, path.read_text(), path.name)

    def test_make(self):
        self.assert_builds("Unix Makefiles")

    def test_a_wrong_call_says_so(self):
        lists = self.project / "CMakeLists.txt"
        text = lists.read_text()
        for was, now, says in (("OUTPUT room.chandelier", "", "needs SOURCES and OUTPUT"),
                               ("room ALL", "room ALL WRONG", "what is 'WRONG'?")):
            lists.write_text(text.replace(was, now, 1))
            code, said = self.configure("Unix Makefiles")
            self.assertNotEqual(code, 0)
            self.assertIn(says, " ".join(said.split()))


if __name__ == "__main__":
    unittest.main()
