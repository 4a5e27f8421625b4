# SPDX-License-Identifier: Apache-2.0
"""A new answer to a stage's question is files of its own and a row in frame.xml: adds one to a copy of the tree, builds it, runs it."""
import filecmp
import json
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import unittest

SOURCE = pathlib.Path(os.environ["CHANDELIER_SOURCE"])
BAKE = os.environ["CHANDELIER_BAKE"]

ROW = '    <answer name="every-other">half of the batches go into every view, the others into none</answer>\n'
COMPUTE = """#version 460
#extension GL_GOOGLE_include_directive : require
#include "shadows/cull/cull.glsl"

bool survives(ShadowView view, BatchInstance candidate) { return candidate.batch % 2u == 0u; }
"""
HEADER = """#pragma once

#include "frame_schema.h"
#include "pack_schema.h"

namespace chandelier {

struct CullEveryOther {
  explicit CullEveryOther(const frame::ShadowView&) {}
  bool survives(const pack::BatchInstance& candidate) const { return candidate.batch % 2 == 0; }
};

}  // namespace chandelier
"""
PARTS = ("CMakeLists.txt", "runtime", "schemas", "setup")  # of the tree: what the portable player is built from


def files_in(folder):
    return {path.relative_to(folder) for part in PARTS for path in [folder / part, *(folder / part).rglob("*")]
            if path.is_file() and "__pycache__" not in path.parts}


class NewAnswer(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        self.tree = self.folder / "tree"
        for part in PARTS:
            copy = shutil.copytree if (SOURCE / part).is_dir() else shutil.copy
            self.tree.mkdir(exist_ok=True)
            copy(SOURCE / part, self.tree / part)

    def run_well(self, *command, env=None):
        done = subprocess.run(list(map(str, command)), capture_output=True, text=True, env=env, cwd=self.folder)
        self.assertEqual(done.returncode, 0, f"{command}\n{done.stdout[-4000:]}{done.stderr[-4000:]}")
        return done.stdout

    def add_answer(self):
        cull = self.tree / "runtime" / "shadows" / "cull"
        (cull / "cull_every_other.comp").write_text(COMPUTE)
        (cull / "cull_every_other.h").write_text(HEADER)
        page = self.tree / "schemas" / "frame.xml"
        text, before = page.read_text(encoding="utf-8"), '    <answer name="light-frustum">'
        self.assertEqual(text.count(before), 1)
        page.write_text(text.replace(before, ROW + before), encoding="utf-8")

    def build(self):
        # Without optimization, and with paths in the compiler's cache that do not depend on the scratch folder.
        env = {**os.environ, "CCACHE_BASEDIR": str(self.folder), "CCACHE_NOHASHDIR": "1"}
        build = self.folder / "build"
        self.run_well("cmake", "-S", self.tree, "-B", build, "-G", "Ninja", "-DCHANDELIER_PORTABLE=ON",
                      "-DCHANDELIER_TESTS=OFF", "-DCMAKE_CXX_FLAGS=-O0", env=env)
        self.run_well("cmake", "--build", build, "--target", "chandelier-play", env=env)
        return build / "bin" / "chandelier-play"

    def counters(self, play, pack, answer, *mode):
        stats = self.folder / "stats.json"
        self.run_well(play, pack, "--cull", answer, "--size", "64x36", "--face-size", "64", "--stats", stats, *mode)
        return json.loads(stats.read_text())["counters"]

    def test_it_is_files_of_its_own_and_a_row(self):
        self.add_answer()
        schema = self.tree / "schemas" / "frame.xml"
        self.run_well(sys.executable, "-B", self.tree / "schemas" / "generate.py", "--schema", schema, "--page",
                      self.tree / "runtime" / "RECIPES.md")
        now, before = files_in(self.tree), files_in(SOURCE)
        changed = {str(f) for f in now if f not in before or not filecmp.cmp(self.tree / f, SOURCE / f, shallow=False)}
        self.assertEqual(changed, {"runtime/shadows/cull/cull_every_other.comp", "runtime/shadows/cull/cull_every_other.h",
                                   "schemas/frame.xml", "runtime/RECIPES.md"})  # the last is generated
        self.assertEqual(before - now, set())

        play, pack = self.build(), self.folder / "room.chandelier"
        self.assertIn("every-other           half of the batches", self.run_well(play, "--help"))
        room = SOURCE / "examples" / "cmake_project"
        self.run_well(BAKE, room / "room.gltf", room / "lamps.gltf", "-o", pack, "--quiet")
        drawn = self.counters(play, pack, "every-other", "--output", self.folder / "a.png")
        predicted = self.counters(play, pack, "every-other", "--predict")
        everything = self.counters(play, pack, "none", "--predict")
        for name in ("shadow_draws", "shadow_triangles"):
            self.assertEqual(drawn[name], predicted[name])
            self.assertGreater(drawn[name], 0)
            self.assertLess(drawn[name], everything[name])


if __name__ == "__main__":
    unittest.main()
