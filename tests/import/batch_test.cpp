// SPDX-License-Identifier: Apache-2.0
// Batches and their boxes: nothing lost, nothing too large, the same on any number of threads.
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>

#include "gltf_builder.h"
#include "pack_checks.h"

namespace chandelier::baker::test {
namespace {

/// A bumpy sheet of `side` by `side` squares, two triangles each, with shared vertices.
GltfBuilder sheet(int side) {
  std::vector<float> positions, normals;
  std::vector<uint32_t> indices;
  for (int y = 0; y <= side; ++y) {
    for (int x = 0; x <= side; ++x) {
      const auto fx = static_cast<float>(x), fy = static_cast<float>(y);
      positions.insert(positions.end(), {fx, fy, std::sin(fx * 0.5f) * std::cos(fy * 0.3f)});
      normals.insert(normals.end(), {0, 0, 1});
    }
  }
  for (int y = 0; y < side; ++y) {
    for (int x = 0; x < side; ++x) {
      const auto a = static_cast<uint32_t>(y * (side + 1) + x), b = a + 1, c = a + static_cast<uint32_t>(side) + 1;
      indices.insert(indices.end(), {a, b, c + 1, a, c + 1, c});
    }
  }
  GltfBuilder gltf;
  const int position = gltf.add_floats(positions, "VEC3", 3), normal = gltf.add_floats(normals, "VEC3", 3);
  gltf.add_mesh({{"attributes", {{"POSITION", position}, {"NORMAL", normal}}},
                 {"indices", gltf.add_accessor(indices, unsigned_int_type, "SCALAR", indices.size())}});
  gltf.add_node({{"mesh", 0}});
  return gltf;
}

/// A triangle's corners, starting with the smallest: the same whatever corner it starts with.
using Corners = std::array<std::array<float, 3>, 3>;

Corners turned(Corners corners) {
  std::rotate(corners.begin(), std::min_element(corners.begin(), corners.end()), corners.end());
  return corners;
}

std::vector<Corners> triangles_of(const Scene& scene) {
  std::vector<Corners> out;
  for (const Primitive& primitive : scene.meshes.at(0).primitives) {
    for (size_t i = 0; i < primitive.indices.size(); i += 3) {
      Corners corners;
      for (size_t c = 0; c < 3; ++c) {
        const glm::vec3& p = primitive.vertices[primitive.indices[i + c]].position_ls;
        corners[c] = {p.x, p.y, p.z};
      }
      out.push_back(turned(corners));
    }
  }
  std::sort(out.begin(), out.end());
  return out;
}

std::vector<Corners> triangles_of(const pack::Contents& pack) {
  std::vector<Corners> out;
  for (const pack::Batch& batch : pack.batches) {
    for (uint32_t i = 0; i < batch.index_count; i += 3) {
      Corners corners;
      for (uint32_t c = 0; c < 3; ++c) {
        const glm::vec3& p = pack.positions[pack.indices[batch.first_index + i + c].vertex].position_ls;
        corners[c] = {p.x, p.y, p.z};
      }
      out.push_back(turned(corners));
    }
  }
  std::sort(out.begin(), out.end());
  return out;
}

TEST(Batches, HoldEachTriangleOnceWithItsWinding) {
  const GltfBuilder gltf = sheet(40);
  const auto expected = triangles_of(gltf.import());
  ASSERT_EQ(expected.size(), 3200u);
  EXPECT_EQ(triangles_of(gltf.bake({.position_error_m = 0})), expected);
}

double area_of(const std::vector<Corners>& triangles) {
  double area = 0;
  for (const Corners& t : triangles) {
    const auto corner = [&](size_t c) { return glm::dvec3(t[c][0], t[c][1], t[c][2]); };
    area += glm::length(glm::cross(corner(1) - corner(0), corner(2) - corner(0))) / 2;
  }
  return area;
}

TEST(Batches, HoldAllOfTheAreaWhereVerticesAreRounded) {
  const GltfBuilder gltf = sheet(40);
  const pack::Contents pack = gltf.bake({.position_error_m = 0.001f});
  EXPECT_GT(pack.bake_info.position_error_m, 0);
  EXPECT_LE(pack.bake_info.position_error_m, 0.001f);
  const auto before = triangles_of(gltf.import()), after = triangles_of(pack);
  EXPECT_EQ(before.size(), after.size());
  EXPECT_NEAR(area_of(after) / area_of(before), 1, 1e-4);
}

TEST(Batches, HaveConesThatCullNoFrontNorThoseOfMirroredCopies) {
  GltfBuilder gltf = sheet(40);
  gltf.add_node({{"mesh", 0}, {"scale", {-1, 1, 1}}});
  const pack::Contents pack = gltf.bake();
  ASSERT_EQ(pack.meshes.size(), 2u);
  size_t culled = 0;
  for (const pack::Batch& batch : pack.batches) {
    for (int e = 0; e < 200; ++e) {  // eyes on a grid around the sheet
      const glm::vec3 eye(-20 + 13 * (e % 6), -20 + 13 * (e / 6 % 6), -30 + 12 * (e / 36));
      const bool culls = batch.cone_cutoff < 1 &&
                         glm::dot(glm::normalize(batch.cone_apex_ls - eye), batch.cone_axis_ls) >= batch.cone_cutoff;
      if (!culls) continue;
      ++culled;
      for (uint32_t i = 0; i < batch.index_count; i += 3) {
        glm::dvec3 p[3];
        for (uint32_t c = 0; c < 3; ++c) {
          p[c] = pack.positions[pack.indices[batch.first_index + i + c].vertex].position_ls;
        }
        EXPECT_LE(glm::dot(glm::cross(p[1] - p[0], p[2] - p[0]), glm::dvec3(eye) - p[0]), 0);
      }
    }
  }
  EXPECT_GT(culled, pack.batches.size() * 40);
}

TEST(Batches, KeepJointsAndWeightsWithTheirVertices) {
  Scene scene = sheet(20).import();
  Primitive& primitive = scene.meshes[0].primitives[0];
  for (const Vertex& vertex : primitive.vertices) {
    const auto x = static_cast<uint16_t>(vertex.position_ls.x), y = static_cast<uint16_t>(vertex.position_ls.y);
    primitive.skin_vertices.push_back({{x, y, 0, 0}, {40000, 25535, 0, 0}});
  }
  const pack::Contents pack = bake_scene(std::move(scene), {});
  ASSERT_EQ(pack.skin_vertices.size(), pack.positions.size());
  EXPECT_EQ(pack.meshes.at(0).skin_vertex_count, pack.positions.size());
  for (size_t i = 0; i < pack.positions.size(); ++i) {
    const glm::vec3& p = pack.positions[i].position_ls;
    EXPECT_EQ(pack.skin_vertices[i].joints[0], static_cast<uint32_t>(p.x) | static_cast<uint32_t>(p.y) << 16);
    EXPECT_EQ(pack.skin_vertices[i].weights[0], 40000u | 25535u << 16);
  }
}

TEST(Batches, HoldAboutAsManyTrianglesAsAskedAndNeverMore) {
  const GltfBuilder gltf = sheet(40);
  for (const uint32_t most : {4u, 64u, 100u, 256u}) {
    const pack::Contents pack = gltf.bake({.batch_triangles = most});
    for (const pack::Batch& batch : pack.batches) EXPECT_LE(batch.index_count, 3 * most);
    EXPECT_LE(pack.batches.size(), 2 * (3200 / most)) << most;
  }
}

TEST(Batches, FollowEachOtherInTheIndicesWithTightBoxes) {
  const pack::Contents pack = sheet(20).bake();
  uint32_t next = 0;
  for (const pack::Batch& batch : pack.batches) {
    EXPECT_EQ(batch.first_index, next);
    next += batch.index_count;
    glm::vec3 low(1e9f), high(-1e9f);
    for (uint32_t i = batch.first_index; i < next; ++i) {
      low = glm::min(low, pack.positions[pack.indices[i].vertex].position_ls);
      high = glm::max(high, pack.positions[pack.indices[i].vertex].position_ls);
    }
    EXPECT_EQ(batch.bounds_min_ls, low);
    EXPECT_EQ(batch.bounds_max_ls, high);
  }
  EXPECT_EQ(next, pack.indices.size());
}

TEST(Batches, AreSmallInSpace) {
  // Neighbours: 32 boxes that cover a sheet of 1600 m2 without overlap would have that area; strangers 32 times it.
  float area = 0;
  for (const pack::Batch& batch : sheet(40).bake().batches) {
    const glm::vec3 size = batch.bounds_max_ls - batch.bounds_min_ls;
    area += size.x * size.y;
  }
  EXPECT_LT(area, 3 * 1600);
}

TEST(Batches, AreMadeOfAFanInReasonableTime) {
  // 100 000 triangles around one vertex: not a matter of half a minute, and the batches are full.
  constexpr int triangle_count = 100000;
  std::vector<float> positions = {0, 0, 0}, normals = {0, 0, 1};
  for (int i = 0; i <= triangle_count; ++i) {
    const double angle = 2 * M_PI * i / triangle_count;
    positions.insert(positions.end(), {static_cast<float>(std::cos(angle)), static_cast<float>(std::sin(angle)), 0});
    normals.insert(normals.end(), {0, 0, 1});
  }
  GltfBuilder gltf;
  const int position = gltf.add_positions(positions), normal = gltf.add_positions(normals);
  gltf.add_mesh({{"mode", 6}, {"attributes", {{"POSITION", position}, {"NORMAL", normal}}}});
  gltf.add_node({{"mesh", 0}});
  const pack::Contents pack = gltf.bake({.position_error_m = 0});
  EXPECT_EQ(pack.indices.size(), 3u * triangle_count);
  EXPECT_LE(pack.batches.size(), 1350u);
  float area = 0;  // of pieces of the rim: about a thousand boxes of a slice each, not of the whole disc
  for (const pack::Batch& batch : pack.batches) {
    const glm::vec3 size = batch.bounds_max_ls - batch.bounds_min_ls;
    area += size.x * size.y;
  }
  EXPECT_LT(area, 0.5f * static_cast<float>(pack.batches.size()));
}

TEST(Batches, LoseNothingWhereDistancesOverflow) {
  GltfBuilder gltf = one_triangle();
  gltf.json["meshes"][0]["primitives"][0]["attributes"]["POSITION"] =
      gltf.add_positions({0, 0, 0, 1e30f, 0, 0, 0, 1e30f, 0});
  EXPECT_EQ(gltf.bake().indices.size(), 3u);
}

TEST(Batches, HaveTheSameBytesOnAnyNumberOfThreads) {
  GltfBuilder gltf = sheet(30);
  for (int i = 0; i < 20; ++i) {
    gltf.json["meshes"][0]["primitives"].push_back(gltf.json["meshes"][0]["primitives"][0]);
  }
  const auto bake_with = [&](size_t threads) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    return gltf.bake();
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

TEST(BatchInstances, HaveBoxesOfTheirVerticesNotOfTurnedBoxes) {
  // The triangle (0,0) (1,0) (0,1), turned by 45 degrees about z: its corners are at (0,0), (r,r) and (-r,r). The
  // turned box of the triangle would reach up to y = 2r.
  GltfBuilder gltf = one_triangle();
  const double r = std::sqrt(0.5);
  gltf.json["nodes"][0]["rotation"] = {0, 0, std::sin(M_PI / 8), std::cos(M_PI / 8)};
  const pack::Contents pack = gltf.bake();
  const pack::BatchInstance& draw = pack.batch_instances.at(0);
  EXPECT_NEAR(draw.bounds_min_ws.x, -r, 1e-6);
  EXPECT_NEAR(draw.bounds_min_ws.y, 0, 1e-6);
  EXPECT_NEAR(draw.bounds_max_ws.x, r, 1e-6);
  EXPECT_NEAR(draw.bounds_max_ws.y, r, 1e-6);
  EXPECT_EQ(pack.bake_info.bounds_max_ws, draw.bounds_max_ws);
}

TEST(BatchInstances, HaveBoxesThatHoldEachVertexExactly) {
  GltfBuilder gltf = sheet(12);
  gltf.json["nodes"][0] = {{"mesh", 0}, {"rotation", {0.1, 0.2, 0.3, 0.9}}, {"translation", {1e5, -3e4, 7}}};
  const pack::Contents pack = gltf.bake();
  for (const pack::BatchInstance& draw : pack.batch_instances) {
    const pack::Batch& batch = pack.batches[draw.batch];
    const pack::Instance& instance = pack.instances[draw.instance];
    for (uint32_t i = 0; i < batch.index_count; ++i) {
      const glm::dvec4 p(pack.positions[pack.indices[batch.first_index + i].vertex].position_ls, 1);
      for (int axis = 0; axis < 3; ++axis) {
        const double world = glm::dot(glm::dvec4(instance.world_from_local[axis]), p);
        EXPECT_LE(draw.bounds_min_ws[axis], world);
        EXPECT_GE(draw.bounds_max_ws[axis], world);
      }
    }
  }
}

TEST(BatchInstances, AreRefusedByNumberBeforeTheyTakeMemory) {
  Scene scene = sheet(100).import();
  const MeshInstance instance = scene.instances[0];
  scene.instances.assign(100000, instance);  // of 5000 batches of 4 triangles or more
  try {
    bake_scene(std::move(scene), {.batch_triangles = 4});
    FAIL() << "baked";
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("batches (2684"), std::string::npos) << error.what();
  }
}

TEST(BatchInstances, AreSortedOpaqueFirstThenByMaterial) {
  GltfBuilder gltf = one_triangle();
  gltf.json["materials"] = {{{"alphaMode", "MASK"}}, {{"name", "a"}}, {{"name", "b"}}};
  const Json primitive = gltf.json["meshes"][0]["primitives"][0];
  gltf.json["meshes"][0]["primitives"] = Json::array();
  for (const int material : {0, 2, 1}) {
    Json copy = primitive;
    copy["material"] = material;
    gltf.json["meshes"][0]["primitives"].push_back(copy);
  }
  gltf.add_node({{"mesh", 0}});
  const pack::Contents pack = gltf.bake();
  ASSERT_EQ(pack.batch_instances.size(), 6u);
  for (size_t i = 1; i < pack.batch_instances.size(); ++i) {
    const auto key = [&](const pack::BatchInstance& draw) {
      const uint32_t material = pack.batches[draw.batch].material;
      return std::tuple(pack.materials[material].alpha_mode, material, draw.instance, draw.batch);
    };
    EXPECT_LT(key(pack.batch_instances[i - 1]), key(pack.batch_instances[i]));
  }
}

TEST(Bake, MakesPacksThatPassTheirOwnCheck) {
  EXPECT_EQ(pack::check(pack::view_of(sheet(10).bake())), "");
  GltfBuilder nothing;
  EXPECT_EQ(pack::check(pack::view_of(nothing.bake())), "");
}

}  // namespace
}  // namespace chandelier::baker::test
