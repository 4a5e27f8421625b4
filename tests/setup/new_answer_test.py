# SPDX-License-Identifier: Apache-2.0
"""A new answer to a stage's question is files of its own and a row in frame.xml: adds two to a copy of the tree, builds it, runs it."""
import filecmp
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import unittest

SOURCE = pathlib.Path(os.environ["CHANDELIER_SOURCE"])
BAKE = os.environ["CHANDELIER_BAKE"]

ROW = '    <answer name="every-other">every batch goes into every other view</answer>\n'
LOOKUP_ROW = '    <answer name="backwards" order="any">every pixel tries every light, the last one first</answer>\n'
LOOKUP_HEADER = """#pragma once

#include "lookup/lookup.h"

namespace chandelier {

struct LookupBackwards {
  static constexpr bool has_pass = false;
  explicit LookupBackwards(const gpu::Device&) {}
  void make_room(const gpu::Device&, const LookupRoom&, gpu::Retired&) {}
  void record(gpu::Commands, const LookupInput&) const {}
  LookupData data() const { return {}; }
};

}  // namespace chandelier
"""
LOOKUP = """uint first_light_backwards() { return group.light_end - 1u; }
uint light_after_backwards(uint light) { return light == group.first_light ? group.light_end : light - 1u; }
"""
COMPUTE = """#version 460
#extension GL_GOOGLE_include_directive : require
#include "shadows/cull/cull.glsl"

bool survives(ShadowView view, BatchInstance candidate) { return view.layer % 2u == 0u; }
"""
HEADER = """#pragma once

#include "frame_schema.h"
#include "pack_schema.h"

namespace chandelier {

struct CullEveryOther {
  explicit CullEveryOther(const frame::ShadowView& view) : taken(view.layer % 2 == 0) {}
  bool survives(const pack::BatchInstance&) const { return taken; }
  bool taken;
};

}  // namespace chandelier
"""
# Says what is drawn and what is predicted with every answer of `cull`, and how bright the picture is with every lookup and
# delivery. Smaller than the player, so that it builds sooner.
PROGRAM = """
#include <cstdio>

#include "frame/renderer.h"
#include "predict/prediction.h"

using namespace chandelier;

int main(int, char** arguments) {
  const pack::File pack(arguments[1]);
  const World world(pack.view());
  gpu::Device device(gpu::DeviceOptions{});
  Renderer renderer(device, world);
  Predictor predictor(world);
  for (const Answer& answer : answers_of(Cull{})) {
    RenderSettings settings;
    set_by_name(settings.recipe.cull, answer.name);
    settings.width = 64, settings.height = 36, settings.recipe.face_size_px = 64;
    settings.camera = {.eye_ws = {0, 1.5f, 2}, .forward_ws = {0, 0, -1}};
    for (const FrameStats& stats : {renderer.draw(settings), predictor.predict(settings).stats})
      std::printf("%s %d %d\\n", answer.name.data(), int(stats.shadow_draws), int(stats.shadow_triangles));
  }
  for (const Answer& delivery : answers_of(Deliver{}))
    for (const Answer& answer : answers_of(Lookup{})) {
      RenderSettings settings;
      set_by_name(settings.recipe.lookup, answer.name);
      set_by_name(settings.recipe.deliver, delivery.name);
      settings.recipe.select = Select::light_clusters, settings.recipe.filter = Filter::pcss;
      settings.recipe.d_init_m = 4.0f, settings.recipe.reference_share = 2.0f;
      settings.width = 64, settings.height = 36, settings.recipe.face_size_px = 64;
      settings.camera = {.eye_ws = {0, 1.5f, 2}, .forward_ws = {0, 0, -1}};
      renderer.draw(settings);
      double sum = 0.0, squares = 0.0;
      for (const float value : renderer.read_back().radiance) sum += value, squares += double(value) * value;
      std::printf("%s %.9g %.9g\\n", answer.name.data(), sum, squares);
    }
}
"""
BUILT = """
add_executable(every_answer ${CMAKE_SOURCE_DIR}/../every_answer.cpp)
target_link_libraries(every_answer PRIVATE chandelier_runtime)
"""
PARTS = ("CMakeLists.txt", "runtime", "schemas", "setup")  # of the tree: what the runtime is built from


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
        (self.tree / "runtime" / "lookup" / "lookup_backwards.glsl").write_text(LOOKUP)
        (self.tree / "runtime" / "lookup" / "lookup_backwards.h").write_text(LOOKUP_HEADER)
        lookup = '    <answer name="tiles">'
        self.assertEqual((text.count(before), text.count(lookup)), (1, 1))
        page.write_text(text.replace(before, ROW + before).replace(lookup, LOOKUP_ROW + lookup), encoding="utf-8")

    def build(self):
        # Without optimization, and with paths in the compiler's cache that do not depend on the scratch folder.
        env = {**os.environ, "CCACHE_BASEDIR": str(self.folder), "CCACHE_NOHASHDIR": "1"}
        build = self.folder / "build"
        (self.folder / "every_answer.cpp").write_text(PROGRAM)
        with (self.tree / "CMakeLists.txt").open("a") as file:
            file.write(BUILT)
        self.run_well("cmake", "-S", self.tree, "-B", build, "-G", "Ninja", "-DCHANDELIER_PORTABLE=ON",
                      "-DCHANDELIER_TESTS=OFF", "-DCMAKE_CXX_FLAGS=-O0", env=env)
        self.run_well("cmake", "--build", build, "--target", "every_answer", env=env)
        return build / "bin" / "every_answer"

    def test_it_is_files_of_its_own_and_a_row(self):
        self.add_answer()
        schema = self.tree / "schemas" / "frame.xml"
        self.run_well(sys.executable, "-B", self.tree / "schemas" / "generate.py", "--schema", schema, "--page",
                      self.tree / "runtime" / "RECIPES.md")
        now, before = files_in(self.tree), files_in(SOURCE)
        changed = {str(f) for f in now if f not in before or not filecmp.cmp(self.tree / f, SOURCE / f, shallow=False)}
        self.assertEqual(changed, {"runtime/shadows/cull/cull_every_other.comp", "runtime/shadows/cull/cull_every_other.h",
                                   "runtime/lookup/lookup_backwards.glsl", "runtime/lookup/lookup_backwards.h", "schemas/frame.xml",
                                   "runtime/RECIPES.md"})  # the last is generated
        self.assertEqual(before - now, set())

        program, pack = self.build(), self.folder / "room.chandelier"
        room = SOURCE / "examples" / "cmake_project"
        self.run_well(BAKE, room / "room.gltf", room / "lamps.gltf", "-o", pack, "--quiet")
        counts = {}
        for line in self.run_well(program, pack).splitlines():
            name, *numbers = line.split()
            counts.setdefault(name, []).append(list(map(float, numbers)))
        pictures = {name: counts.pop(name) for name in ("all", "tiles", "backwards")}
        self.assertGreater(pictures["all"][0][0], 0)
        for name, by_delivery in pictures.items():  # sums of floats in another order
            for found, expected in zip(by_delivery, pictures["all"], strict=True):
                for a, b in zip(found, expected, strict=True):
                    self.assertAlmostEqual(a / b, 1, delta=1e-5, msg=name)
        for name, (drawn, predicted) in counts.items():
            self.assertEqual(drawn, predicted, name)
        draws, triangles = counts["every-other"][0]
        self.assertGreater(draws, 0)
        self.assertEqual([2 * draws, 2 * triangles], counts["none"][0])


if __name__ == "__main__":
    unittest.main()
