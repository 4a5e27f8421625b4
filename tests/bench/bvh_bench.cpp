// SPDX-License-Identifier: Apache-2.0
// Triangle BVHs: how fast and how good. Real scenes where the test data is, and a generated terrain.
#include <benchmark/benchmark.h>

#include <cmath>
#include <filesystem>
#include <string>
#include <vector>

#include "bake/bake.h"
#include "bake/bvh.h"
#include "bake/triangle_bvh.h"
#include "import/import.h"

namespace {

using namespace chandelier;
using namespace chandelier::baker;

Scene terrain(uint32_t side) {
  Primitive primitive;
  for (uint32_t y = 0; y <= side; ++y) {
    for (uint32_t x = 0; x <= side; ++x) {
      const auto fx = static_cast<float>(x), fy = static_cast<float>(y);
      primitive.vertices.push_back({.position_ls = {fx, 20 * std::sin(fx * 0.02f) * std::cos(fy * 0.03f), fy}});
    }
  }
  for (uint32_t y = 0; y < side; ++y) {
    for (uint32_t x = 0; x < side; ++x) {
      const uint32_t a = y * (side + 1) + x, c = a + side + 1;
      primitive.indices.insert(primitive.indices.end(), {a, c + 1, a + 1, a, c, c + 1});
    }
  }
  Scene scene;
  scene.materials.emplace_back();
  scene.meshes.emplace_back().primitives.push_back(std::move(primitive));
  scene.instances.emplace_back();
  return scene;
}

/// A file's geometry, without its textures.
Scene file(const char* name) {
  Scene scene;
  Warnings warnings;
  import_gltf(std::filesystem::path(CHANDELIER_DATA_DIR) / "scenes" / name, scene, warnings);
  for (Material& material : scene.materials) {
    for (TextureUse* use : {&material.base_color, &material.metallic_roughness, &material.normal, &material.occlusion,
                            &material.emissive_map}) {
      use->texture = no_index;
    }
  }
  return scene;
}

pack::Contents baked(Scene scene) {
  Report report;
  Warnings warnings;
  return bake(std::move(scene), {}, Progress(false), report, warnings);
}

void set_counters(benchmark::State& state, uint64_t triangles, double nodes, double sah_cost) {
  const auto count = static_cast<double>(triangles);
  state.counters["triangles"] = count;
  state.counters["triangles/s"] = benchmark::Counter(count, benchmark::Counter::kIsIterationInvariantRate);
  state.counters["nodes/triangle"] = nodes / count;
  state.counters["sah_cost"] = sah_cost;
}

void build(benchmark::State& state, pack::Contents pack) {
  PassReport pass;
  for (auto iteration : state) {
    pack.triangle_bvh = {};
    pack.triangle_bvh_items = {};
    pack.triangle_bvh_areas = {};
    pass = {};
    make_triangle_bvh(pass, pack);
  }
  double sah_cost = 0;
  for (const auto& [what, value] : pass.counts) {
    if (what == "sah_cost") sah_cost = value;
  }
  set_counters(state, pack.triangle_bvh_items.size(), static_cast<double>(pack.triangle_bvh.size()), sah_cost);
}

void add(const std::string& name, Scene scene) {
  const pack::Contents pack = baked(std::move(scene));
  benchmark::RegisterBenchmark(("triangle_bvh/" + name).c_str(), [=](benchmark::State& state) { build(state, pack); })
      ->Unit(benchmark::kMillisecond)
      ->MeasureProcessCPUTime()
      ->UseRealTime();
}

}  // namespace

int main(int argc, char** argv) {
  benchmark::Initialize(&argc, argv);
  add("terrain", terrain(argc > 1 ? static_cast<uint32_t>(std::stoul(argv[1])) : 700));
  for (const char* name : {"crytek_sponza/crytek_sponza.gltf", "stk_candela_city/candela_city.gltf",
                           "classroom/classroom.gltf", "nexuiz_stormkeep/stormkeep.gltf"}) {
    const std::filesystem::path path = std::filesystem::path(CHANDELIER_DATA_DIR) / "scenes" / name;
    if (std::filesystem::exists(path)) add(path.stem().string(), file(name));
  }
  benchmark::RunSpecifiedBenchmarks();
}
