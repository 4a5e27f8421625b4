// SPDX-License-Identifier: Apache-2.0
// The hierarchies of whole packs against what they should hold.
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <cmath>

#include "bake/batch_bvh.h"
#include "bvh_expect.h"
#include "gltf_builder.h"
#include "import/import.h"
#include "pack_checks.h"

namespace chandelier::baker::test {
namespace {

/// A sheet of `side` by `side` squares at a height.
Primitive sheet(uint32_t side, float height) {
  Primitive out;
  for (uint32_t y = 0; y <= side; ++y) {
    for (uint32_t x = 0; x <= side; ++x) {
      out.vertices.push_back({.position_ls = {static_cast<float>(x), height, static_cast<float>(y)}});
    }
  }
  for (uint32_t y = 0; y < side; ++y) {
    for (uint32_t x = 0; x < side; ++x) {
      const uint32_t a = y * (side + 1) + x, c = a + side + 1;
      out.indices.insert(out.indices.end(), {a, c + 1, a + 1, a, c, c + 1});
    }
  }
  return out;
}

/// A fan of slivers around one vertex.
Primitive hub(uint32_t triangles) {
  Primitive out;
  out.vertices.push_back({});
  for (uint32_t i = 0; i <= triangles; ++i) {
    const double angle = 2 * M_PI * i / triangles;
    out.vertices.push_back({.position_ls = {100 * std::cos(angle), 100 * std::sin(angle), 0}});
    if (i > 0) out.indices.insert(out.indices.end(), {0, i, i + 1});
  }
  return out;
}

/// Two floors of one mesh and a hub, in several places, one of them mirrored.
Scene sheets_and_hub() {
  Scene scene;
  scene.materials.emplace_back();
  scene.meshes.resize(2);
  scene.meshes[0].primitives = {sheet(30, 0), sheet(20, 3)};
  scene.meshes[1].primitives = {hub(3000)};
  for (int i = 0; i < 5; ++i) {
    MeshInstance instance;
    instance.mesh = static_cast<uint32_t>(i) % 2;
    instance.world_from_local[3] = {50 * i, 7, -20 * i, 1};
    if (i == 4) instance.world_from_local[0].x = -1;
    scene.instances.push_back(instance);
  }
  return scene;
}

BvhItem triangle_of(const pack::Contents& pack, uint32_t triangle) {
  const auto corner = [&](size_t c) { return pack.positions[pack.indices[triangle * 3 + c].vertex].position_ls; };
  const glm::dvec3 cross =
      glm::cross(glm::dvec3(corner(1)) - glm::dvec3(corner(0)), glm::dvec3(corner(2)) - glm::dvec3(corner(0)));
  return {glm::min(glm::min(corner(0), corner(1)), corner(2)), triangle,
          glm::max(glm::max(corner(0), corner(1)), corner(2)), static_cast<float>(glm::length(cross) / 2)};
}

/// Every hierarchy of a pack against all that it should hold.
void expect_hierarchies(const pack::Contents& pack, int queries) {
  ASSERT_EQ(pack::check(pack::view_of(pack)), "");
  const Box world{pack.bake_info.bounds_min_ws, pack.bake_info.bounds_max_ws};
  const std::vector<pack::NodeArea> no_areas(std::max(pack.batch_bvh.size(), pack.instance_bvh.size()));

  size_t static_batches = 0;
  for (const auto& draw : pack.batch_instances) static_batches += pack.instances[draw.instance].dynamic == 0;
  ASSERT_EQ(pack.batch_bvh_items.size(), static_batches);
  const auto batch_of = [&](uint32_t i) -> BvhItem {
    const uint32_t number = pack.batch_bvh_items[i].batch_instance;
    return {pack.batch_instances[number].bounds_min_ws, number, pack.batch_instances[number].bounds_max_ws, 0};
  };
  expect_tree(pack.batch_bvh, no_areas, 0, static_cast<uint32_t>(pack.batch_bvh.size()), 0, batch_of);
  EXPECT_TRUE(expect_found(pack.batch_bvh, 0, static_cast<uint32_t>(pack.batch_bvh.size()), 0,
                           static_cast<uint32_t>(static_batches), batch_of, random_queries(world, queries, 1)));

  const auto instance_of = [&](uint32_t i) {
    BvhItem out = {glm::vec3(largest_float), pack.instance_bvh_items[i].instance, glm::vec3(-largest_float), 0};
    for (const auto& draw : pack.batch_instances) {
      if (draw.instance != out.number) continue;
      out.low = glm::min(out.low, draw.bounds_min_ws);
      out.high = glm::max(out.high, draw.bounds_max_ws);
    }
    return out;
  };
  expect_tree(pack.instance_bvh, no_areas, 0, static_cast<uint32_t>(pack.instance_bvh.size()), 0, instance_of);

  const auto triangle_at = [&](uint32_t i) { return triangle_of(pack, pack.triangle_bvh_items[i].triangle); };
  uint32_t first_item = 0;
  for (const pack::Mesh& mesh : pack.meshes) {
    uint32_t items = 0;
    for (uint32_t b = 0; b < mesh.batch_count; ++b) items += pack.batches[mesh.first_batch + b].index_count / 3;
    const uint32_t end = mesh.first_node + mesh.node_count;
    expect_tree(pack.triangle_bvh, pack.triangle_bvh_areas, mesh.first_node, end, first_item, triangle_at);
    expect_found(pack.triangle_bvh, mesh.first_node, end, first_item, items, triangle_at,
                 random_queries({mesh.bounds_min_ls, mesh.bounds_max_ls}, queries, 2));
    first_item += items;
  }
  ASSERT_EQ(pack.triangle_bvh_items.size(), first_item);
}

TEST(PackBvh, HoldsBatchesInstancesAndTriangles) {
  const pack::Contents pack = bake_scene(sheets_and_hub(), {});
  EXPECT_EQ(pack.meshes.size(), 3u);  // the sheets, also mirrored, and the hub
  expect_hierarchies(pack, 50);
}

TEST(PackBvh, SumsTheAreasOfAllTriangles) {
  const pack::Contents pack = bake_scene(sheets_and_hub(), {});
  EXPECT_NEAR(pack.triangle_bvh_areas[pack.meshes[0].first_node].area_m2, 30 * 30 + 20 * 20, 1e-2);
  const double slice = 0.5 * 100 * 100 * std::sin(2 * M_PI / 3000);
  EXPECT_NEAR(pack.triangle_bvh_areas[pack.meshes.back().first_node].area_m2, 3000 * slice, 3000 * slice * 0x1p-11);
}

TEST(PackBvh, LeavesOutWhatMoves) {
  pack::Contents pack = bake_scene(sheets_and_hub(), {});
  pack.instances[1].dynamic = pack.instances[2].dynamic = 1;
  PassReport pass;
  make_batch_bvh(pass, pack);
  make_instance_bvh(pass, pack);
  pack.voxel_grid = {};
  pack.voxel_cells = {};
  pack.voxel_runs = {};
  pack.voxel_indices = {};
  pack.voxel_vertices = {};
  pack.voxel_occupancy = {};
  for (pack::Light& light : pack.lights) light.voxel = pack::none;
  EXPECT_EQ(pack.instance_bvh_items.size(), 3u);
  expect_hierarchies(pack, 20);
  for (pack::Instance& instance : pack.instances) instance.dynamic = 1;
  make_batch_bvh(pass, pack);
  make_instance_bvh(pass, pack);
  EXPECT_TRUE(pack.batch_bvh.empty() && pack.batch_bvh_items.empty());
  EXPECT_TRUE(pack.instance_bvh.empty() && pack.instance_bvh_items.empty());
}

TEST(PackBvh, IsThereForOneTriangleAndNotForNone) {
  const pack::Contents one = one_triangle().bake();
  ASSERT_EQ(one.triangle_bvh.size(), 1u);
  EXPECT_EQ(one.triangle_bvh[0].leaf, 1u);
  EXPECT_EQ(one.triangle_bvh_areas[0].area_m2, 0.5f);
  EXPECT_EQ(one.batch_bvh.size(), 1u);
  EXPECT_EQ(one.instance_bvh.size(), 1u);
  const pack::Contents none = GltfBuilder().bake();
  EXPECT_TRUE(none.triangle_bvh.empty() && none.batch_bvh.empty() && none.instance_bvh.empty());
}

TEST(PackBvh, IsTheSameOnAnyNumberOfThreads) {
  const auto bake_with = [&](size_t threads) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    Scene scene = sheets_and_hub();
    scene.meshes[0].primitives.push_back(sheet(250, 9));  // enough for several threads
    return bake_scene(std::move(scene), {});
  };
  const pack::Contents one = bake_with(1), four = bake_with(4);
  EXPECT_TRUE(same_bytes(one.batch_bvh, four.batch_bvh));
  EXPECT_TRUE(same_bytes(one.batch_bvh_items, four.batch_bvh_items));
  EXPECT_TRUE(same_bytes(one.instance_bvh, four.instance_bvh));
  EXPECT_TRUE(same_bytes(one.instance_bvh_items, four.instance_bvh_items));
  EXPECT_TRUE(same_bytes(one.triangle_bvh, four.triangle_bvh));
  EXPECT_TRUE(same_bytes(one.triangle_bvh_items, four.triangle_bvh_items));
  EXPECT_TRUE(same_bytes(one.triangle_bvh_areas, four.triangle_bvh_areas));
}

/// A file's geometry, without its textures.
Scene geometry_of(const std::filesystem::path& path) {
  Scene scene;
  Warnings warnings;
  import_gltf(path, scene, warnings);
  for (Material& material : scene.materials) {
    for (TextureUse* use : {&material.base_color, &material.metallic_roughness, &material.normal, &material.occlusion,
                            &material.emissive_map}) {
      use->texture = no_index;
    }
  }
  return scene;
}

class PackBvhOfScenes : public testing::TestWithParam<const char*> {};

TEST_P(PackBvhOfScenes, HoldEverythingOnce) {
  const std::filesystem::path path = std::filesystem::path(CHANDELIER_DATA_DIR) / "scenes" / GetParam();
  if (!std::filesystem::exists(path)) GTEST_SKIP() << "no " << path;
  expect_hierarchies(bake_scene(geometry_of(path), {}), 3);
}

INSTANTIATE_TEST_SUITE_P(Each, PackBvhOfScenes,
                         testing::Values("crytek_sponza/crytek_sponza.gltf", "stk_candela_city/candela_city.gltf"));

}  // namespace
}  // namespace chandelier::baker::test
