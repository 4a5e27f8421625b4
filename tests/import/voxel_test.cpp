// SPDX-License-Identifier: Apache-2.0
// Voxel bins: every static triangle in every cell that it overlaps or always drawn; clipped, all of its area once.
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <map>
#include <random>
#include <set>

#include "bake/voxel_bins.h"
#include "gltf_builder.h"
#include "import/import.h"
#include "pack_checks.h"
#include "voxel_expect.h"

namespace chandelier::baker::test {
namespace {

/// The pack with other voxels.
pack::Contents with_voxels(pack::Contents pack, const VoxelSettings& settings, PassReport* report = nullptr) {
  pack.voxel_grid.clear(), pack.voxel_cells.clear(), pack.voxel_runs.clear();
  pack.voxel_indices.clear(), pack.voxel_vertices.clear(), pack.voxel_occupancy.clear();
  for (pack::Light& light : pack.lights) light.voxel = pack::none;
  PassReport unread;
  make_voxels(settings, Progress(false), pack, report ? *report : unread);
  return pack;
}

/// `count` triangles around points in a box of 10 m, from a hair to some metres large, in two instances, one of them
/// turned and mirrored; every second mesh masked.
GltfBuilder soup(int count, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> place(-5, 5), unit(-1, 1), power(-4, 0.5f);
  GltfBuilder gltf;
  gltf.json["materials"] = {{{"name", "stone"}}, {{"name", "leaf"}, {"alphaMode", "MASK"}}};
  for (int material = 0; material < 2; ++material) {
    std::vector<float> positions;
    for (int t = 0; t < count / 4; ++t) {
      const std::array<float, 3> middle = {place(random), place(random), place(random)};
      const float size = std::pow(10.0f, power(random));
      for (size_t i = 0; i < 9; ++i) positions.push_back(middle[i % 3] + size * unit(random));
    }
    gltf.add_mesh({{"attributes", {{"POSITION", gltf.add_positions(positions)}}}, {"material", material}});
    gltf.add_node({{"mesh", material}});
    gltf.add_node({{"mesh", material},
                   {"rotation", {0.1, 0.7, 0.1, 0.7}},
                   {"scale", {-0.5, 1, 1.5}},
                   {"translation", {3, 1, 2}}});
  }
  return gltf;
}

pack::Contents bake_file(const std::string& path) {
  Scene scene;
  Warnings warnings;
  import_gltf(std::string(CHANDELIER_DATA_DIR) + path, scene, warnings);
  BakeSettings settings;
  settings.images.textures = TextureMode::none;
  return bake_scene(std::move(scene), settings);
}

constexpr VoxelSettings clip_settings = {{32, 32, 32}, pack::VoxelMode::clip};

TEST(Voxels, HaveEachTriangleInEachCellThatItOverlaps) {
  const pack::Contents pack = soup(2000, 1).bake();
  expect_separate(pack);
  EXPECT_GT(pack.voxel_grid[0].no_cull_run_count, 0u);
  for (const std::array<uint32_t, 3>& resolution :
       {std::array<uint32_t, 3>{1, 1, 1}, {2, 2, 2}, {3, 1, 2}, {64, 5, 17}, {1, 1, 1000}}) {
    expect_separate(with_voxels(pack, {resolution, pack::VoxelMode::separate}));
  }
}

TEST(Voxels, HaveTrianglesThatLieInFacesOnBothSides) {
  // A floor of unit squares in a cube of 8 cells a side whose planes are whole numbers: all corners lie on planes.
  GltfBuilder gltf;
  std::vector<float> positions;
  for (int y = 0; y < 6; ++y) {
    for (int x = 0; x < 6; ++x) {
      const auto fx = static_cast<float>(x), fy = static_cast<float>(y);
      positions.insert(positions.end(), {fx, 2, fy, fx, 2, fy + 1, fx + 1, 2, fy});
      positions.insert(positions.end(),
                       {fx + 0.25f, 2, fy + 0.25f, fx + 0.25f, 2, fy + 0.75f, fx + 0.75f, 2, fy + 0.25f});
    }
  }
  gltf.add_mesh({{"attributes", {{"POSITION", gltf.add_positions(positions)}}}});
  gltf.add_node({{"mesh", 0}});
  const pack::Contents pack = gltf.bake();
  expect_separate(pack);
  expect_clipped(with_voxels(pack, clip_settings));
}

TEST(Voxels, HaveAllAreaOnceWhereTheyAreClipped) {
  const pack::Contents pack = soup(2000, 2).bake();
  for (const std::array<uint32_t, 3>& resolution :
       {std::array<uint32_t, 3>{1, 1, 1}, {2, 2, 2}, {32, 32, 32}, {3, 70, 1}}) {
    PassReport report;
    const pack::Contents clipped = with_voxels(pack, {resolution, pack::VoxelMode::clip}, &report);
    expect_clipped(clipped);
    const auto said = std::find_if(report.counts.begin(), report.counts.end(),
                                   [](const auto& count) { return count.first == "clipped_area_error"; });
    ASSERT_NE(said, report.counts.end());
    EXPECT_LT(said->second, 1e-4);
  }
}

TEST(Voxels, TellWhatTheyHold) {
  PassReport report;
  const pack::Contents pack = with_voxels(soup(1000, 3).bake(), {{8, 8, 8}, pack::VoxelMode::separate}, &report);
  std::map<std::string, double> counts(report.counts.begin(), report.counts.end());
  double occupied = 0, no_cull = 0, triangles = 0;
  for (const pack::VoxelWord& word : pack.voxel_occupancy) occupied += std::popcount(word.bits);
  for (const auto& [placed, cells] : cells_of_triangles(pack)) {
    for (const auto& [cell, count] : cells) (cell == 512 ? no_cull : triangles) += count;
  }
  EXPECT_EQ(counts["cells"], 512);
  EXPECT_EQ(counts["occupied_cells"], occupied);
  EXPECT_EQ(counts["runs"], static_cast<double>(pack.voxel_runs.size()));
  EXPECT_EQ(counts["no_cull_triangles"], no_cull);
  EXPECT_EQ(counts["triangles"], triangles + no_cull);
  EXPECT_GT(no_cull, 0);
}

TEST(Voxels, HoldLongRuns) {
  // In a cell, an instance's triangles of a material are one run, and runs follow the order of batch instances.
  const pack::Contents pack = soup(8000, 4).bake({.voxels = {{2, 2, 2}}});
  for (const pack::VoxelCell& cell : pack.voxel_cells) {
    std::set<std::array<uint32_t, 3>> seen;
    std::array<uint32_t, 3> last = {};
    for (uint32_t r = cell.first_run; r < cell.first_run + cell.run_count; ++r) {
      const pack::VoxelRun& run = pack.voxel_runs[r];
      const bool masked = pack.materials[run.material].alpha_mode == pack::AlphaMode::mask;
      const std::array<uint32_t, 3> key = {masked ? 1u : 0u, run.material, run.instance};
      EXPECT_TRUE(seen.insert(key).second);
      EXPECT_LE(last, key);
      last = key;
    }
    EXPECT_EQ(seen.size(), 4u);
  }
}

TEST(Voxels, AreLeftOutOnRequestAndWithoutTriangles) {
  const pack::Contents none = soup(100, 5).bake({.voxels = {{0, 0, 0}}});
  EXPECT_TRUE(none.voxel_grid.empty() && none.voxel_cells.empty() && none.voxel_occupancy.empty());
  EXPECT_EQ(pack::check(pack::view_of(none)), "");
  GltfBuilder nothing;
  EXPECT_TRUE(nothing.bake().voxel_grid.empty());
}

TEST(Voxels, HoldNothingThatMoves) {
  pack::Contents pack = soup(400, 6).bake();
  pack.batch_bvh.clear(), pack.batch_bvh_items.clear();  // they hold it still
  pack.instance_bvh.clear(), pack.instance_bvh_items.clear();
  pack.instances[1].dynamic = 1;
  const pack::Contents some = with_voxels(pack, {});
  expect_separate(some);
  for (const pack::VoxelRun& run : some.voxel_runs) EXPECT_NE(run.instance, 1u);
  expect_clipped(with_voxels(pack, clip_settings));
  for (pack::Instance& instance : pack.instances) instance.dynamic = 1;
  EXPECT_TRUE(with_voxels(pack, {}).voxel_grid.empty());
}

TEST(Voxels, HoldNothingThatThrowsNoShadow) {
  pack::Contents pack = soup(400, 6).bake();
  ASSERT_GT(pack.instances.size(), 1u);
  pack.instances[1].shadowless = 1;
  for (const VoxelSettings& settings : {VoxelSettings{}, clip_settings}) {
    const pack::Contents some = with_voxels(pack, settings);
    EXPECT_EQ(pack::check(pack::view_of(some)), "");
    ASSERT_FALSE(some.voxel_runs.empty());
    for (const pack::VoxelRun& run : some.voxel_runs) EXPECT_NE(run.instance, 1u);
  }
  for (pack::Material& material : pack.materials) material.shadowless = 1;
  const pack::Contents none = with_voxels(pack, {});
  EXPECT_EQ(pack::check(pack::view_of(none)), "");
  EXPECT_TRUE(none.voxel_runs.empty());
}

TEST(Voxels, HoldFlatScenes) {
  for (size_t axis = 0; axis < 3; ++axis) {
    std::vector<float> positions = {0, 0, 0, 4, 4, 4, 0, 0, 0, 1, 1, 1, 1.1f, 1.1f, 1.1f, 1, 1, 1};
    positions[(axis + 1) % 3 + 6] = positions[(axis + 1) % 3 + 15] = 3;
    for (size_t i = axis; i < positions.size(); i += 3) positions[i] = 7;
    GltfBuilder gltf;
    gltf.add_mesh({{"attributes", {{"POSITION", gltf.add_positions(positions)}}}});
    gltf.add_node({{"mesh", 0}});
    const pack::Contents pack = gltf.bake();
    expect_separate(pack);
    expect_clipped(with_voxels(pack, clip_settings));
  }
}

TEST(Voxels, RefuseAGridThatNoFloatHolds) {
  GltfBuilder gltf = one_triangle();
  gltf.json["meshes"][0]["primitives"][0]["attributes"]["POSITION"] =
      gltf.add_positions({-3e38f, 0, 0, 3e38f, 0, 0, 0, 3.4e38f, 0});
  try {
    gltf.bake({.voxels = {{1, 1, 1}}});
    FAIL() << "baked";
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("too wide for a voxel grid"), std::string::npos) << error.what();
  }
}

TEST(Voxels, CarryTheTextureCoordinatesThatAMaskReads) {
  // A masked square of 4 m whose uv0 is (x, z) / 4 and whose uv1 is (z, x) / 8; an opaque one needs none.
  for (const int uv_set : {0, 1}) {
    GltfBuilder gltf;
    gltf.json["images"] = {{{"uri",
                             "data:image/png;base64,"
                             "iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAYAAAAfFcSJAAAADUlEQVR42mP8z8BQDwAEhQGAhKmMIQAAAABJRU5E"
                             "rkJggg=="}}};
    gltf.json["textures"] = {{{"source", 0}}};
    const Json map = {{"index", 0}, {"texCoord", uv_set}};
    gltf.json["materials"] = {{{"alphaMode", "MASK"}, {"pbrMetallicRoughness", {{"baseColorTexture", map}}}},
                              {{"pbrMetallicRoughness", {{"baseColorTexture", map}}}}};
    const int position = gltf.add_positions({0, 0, 0, 0, 0, 4, 4, 0, 0, 4, 0, 4});
    const int uv0 = gltf.add_floats({0, 0, 0, 1, 1, 0, 1, 1}, "VEC2", 2);
    const int uv1 = gltf.add_floats({0, 0, 0.5f, 0, 0, 0.5f, 0.5f, 0.5f}, "VEC2", 2);
    for (const int material : {0, 1}) {
      gltf.add_mesh({{"attributes", {{"POSITION", position}, {"TEXCOORD_0", uv0}, {"TEXCOORD_1", uv1}}},
                     {"indices", gltf.add_indices({0, 1, 2, 1, 3, 2})},
                     {"material", material}});
      gltf.add_node({{"mesh", material}, {"translation", {0, material * 2, 0}}});
    }
    const pack::Contents pack = gltf.bake({.voxels = {{5, 5, 5}, pack::VoxelMode::clip}});
    expect_clipped(pack);
    int masked = 0;
    for (const pack::VoxelRun& run : pack.voxel_runs) {
      for (uint32_t i = run.first_index; i < run.first_index + run.index_count; ++i) {
        const pack::VoxelVertex& v = pack.voxel_vertices[pack.voxel_indices[i].vertex];
        const bool mask = pack.materials[run.material].alpha_mode == pack::AlphaMode::mask;
        masked += mask;
        const float x = v.position_ws.x / 4, z = v.position_ws.z / 4;
        const glm::vec2 expected = !mask ? glm::vec2(0) : uv_set ? glm::vec2(z, x) / 2.0f : glm::vec2(x, z);
        EXPECT_NEAR(v.uv.x, expected.x, 1e-4);
        EXPECT_NEAR(v.uv.y, expected.y, 1e-4);
      }
    }
    EXPECT_GT(masked, 25 * 6);
  }
}

TEST(Voxels, KeepFrontsInFrontWhereTheyAreClipped) {
  // Mirrored instances too: normals of clipped parts point as the baked triangle's.
  GltfBuilder gltf = one_triangle();
  gltf.add_node({{"mesh", 0}, {"scale", {-1, 1, 1}}});
  const pack::Contents pack = gltf.bake({.voxels = {{7, 7, 7}, pack::VoxelMode::clip}});
  for (size_t i = 0; i < pack.voxel_indices.size(); i += 3) {
    const auto at = [&](size_t c) { return pack.voxel_vertices[pack.voxel_indices[i + c].vertex].position_ws; };
    EXPECT_GT(glm::cross(at(1) - at(0), at(2) - at(0)).z, 0);
  }
}

TEST(Voxels, HaveTheSameBytesOnAnyNumberOfThreads) {
  const GltfBuilder gltf = soup(20000, 7);
  for (const pack::VoxelMode mode : {pack::VoxelMode::separate, pack::VoxelMode::clip}) {
    const auto bake_with = [&](size_t threads) {
      const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
      return gltf.bake({.voxels = {{16, 16, 16}, mode}});
    };
    const pack::Contents one = bake_with(1), four = bake_with(4);
    const pack::View a = pack::view_of(one), b = pack::view_of(four);
    for (size_t i = 0; i < pack::section_infos.size(); ++i) {
      const auto left = pack::section_bytes(a, i), right = pack::section_bytes(b, i);
      ASSERT_EQ(left.size(), right.size());
      EXPECT_TRUE(left.empty() || std::memcmp(left.data(), right.data(), left.size()) == 0)
          << pack::section_infos[i].name;
    }
  }
}

class VoxelScenes : public testing::TestWithParam<const char*> {};

TEST_P(VoxelScenes, MissNoTriangleAndLoseNoArea) {
  const std::string path = GetParam();
  if (!std::filesystem::exists(std::string(CHANDELIER_DATA_DIR) + path)) GTEST_SKIP() << path << " is not here";
  const pack::Contents pack = bake_file(path);
  expect_separate(pack);
  expect_clipped(with_voxels(pack, clip_settings));
}

INSTANTIATE_TEST_SUITE_P(Each, VoxelScenes,
                         testing::Values("/scenes/crytek_sponza/crytek_sponza.gltf",
                                         "/scenes/nexuiz_stormkeep/stormkeep.gltf",
                                         "/scenes/cornell_box/CornellBox-Original.gltf"));

}  // namespace
}  // namespace chandelier::baker::test
