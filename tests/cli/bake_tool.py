# SPDX-License-Identifier: Apache-2.0
"""What the tests of chandelier-bake share: the programs, scenes to bake, and a folder for each test."""
import json
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import unittest

SOURCE = pathlib.Path(__file__).resolve().parents[2]
BAKE = os.environ["CHANDELIER_BAKE"]
INSPECT = os.environ["CHANDELIER_INSPECT"]
DATA = pathlib.Path(os.environ.get("CHANDELIER_DATA_DIR", SOURCE.parent / "shared" / "data"))
ROOM = SOURCE / "examples" / "cmake_project"


NOTHING_THERE = re.compile(r"^(chandelier-bake: warning: )?scene: (triangles|lights): there are none[^\n]*\n?", re.MULTILINE)


def without_emptiness(done):
    """The process without the lines that say of a small test scene that it lacks triangles or lights."""
    done.stderr = NOTHING_THERE.sub("", done.stderr)
    return done


def without_slow_passes(done):
    """The process without the lines that a slow machine adds: each pass that took more than a second."""
    done.stderr = re.sub(r"^chandelier-bake: +\d+\.\d\d s: +\d+\.\d\d s for .*\n", "", done.stderr, flags=re.MULTILINE)
    return done


class BakeTool(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        self.pack = self.folder / "out.chandelier"

    def room(self, folder="room"):
        """A copy of the example project's scene: glTF, rig, buffer and image. Returns glTF and rig."""
        copy = self.folder / folder
        shutil.copytree(ROOM, copy)
        return copy / "room.gltf", copy / "lamps.gltf"

    def example(self, name):
        """A scene that a script of examples/ makes."""
        path = self.folder / f"{name}.glb"
        subprocess.run([sys.executable, SOURCE / "examples" / f"{name}.py", "-o", path], check=True, stdout=subprocess.DEVNULL)
        return path

    def data(self, path):
        """A file of the test data; the test is skipped where it is absent."""
        if not (DATA / path).exists():
            self.skipTest(f"no {path} in the test data")
        return DATA / path

    def run_bake(self, *arguments, **options):
        done = subprocess.run([BAKE, *map(str, arguments)], capture_output=True, text=True, cwd=self.folder, **options)
        return done if "--verbose" in arguments else without_slow_passes(done)

    def bake(self, *arguments, output=None):
        """A bake that must work; returns the pack's bytes and the report."""
        output = output or self.pack
        report = self.folder / "report.json"
        done = self.run_bake(*arguments, "-o", output, "--json", report, "--quiet")
        self.assertEqual(done.returncode, 0, done.stderr)
        told = json.loads(report.read_text())
        told["warnings"] = [line for line in told["warnings"] if not NOTHING_THERE.match(line)]
        return output.read_bytes(), told

    def assert_opens(self, pack):
        done = subprocess.run([INSPECT, pack, "--json"], capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, done.stderr)

    def names(self, folder):
        return sorted(path.name for path in folder.iterdir())


def move_lights(rig, by=0.25):
    """Moves every light of a .gltf, and nothing else."""
    gltf = json.loads(rig.read_text())
    for node in gltf["nodes"]:
        node["translation"] = [x + by for x in node.get("translation", [0, 0, 0])]
    rig.write_text(json.dumps(gltf))


def main():
    """As unittest.main(), but exits with 77, which CTest shows as skipped, where every test was skipped."""
    program = unittest.main(module="__main__", exit=False)
    result = program.result
    if result.wasSuccessful() and result.testsRun and len(result.skipped) == result.testsRun:
        sys.exit(77)
    sys.exit(not result.wasSuccessful())
