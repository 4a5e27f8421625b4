// SPDX-License-Identifier: Apache-2.0
// Quantization: the errors that the pack states hold against the input, places that were shared stay shared.
#include "bake/quantize.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cmath>
#include <cstring>
#include <random>

#include "octahedral.h"

namespace chandelier::baker::test {
namespace {

float between(std::mt19937& random, double low, double high) {
  return static_cast<float>(low + (high - low) * (static_cast<double>(random()) / 4294967296.0));
}

glm::vec3 direction(std::mt19937& random) {
  while (true) {
    const glm::vec3 v(between(random, -1, 1), between(random, -1, 1), between(random, -1, 1));
    if (glm::length(v) > 0.1f && glm::length(v) < 1) return glm::normalize(v);
  }
}

/// Two primitives of random triangles, the second with the first's places; the first reads all attributes.
Scene random_scene(std::mt19937& random, float size) {
  Scene scene;
  scene.materials.resize(2);
  scene.materials[0].normal.texture = 0;
  scene.materials[0].base_color.texture = 0;
  scene.materials[0].base_color.uv1 = true;
  scene.meshes.resize(1);
  scene.meshes[0].primitives.resize(2);
  for (int p = 0; p < 2; ++p) {
    Primitive& primitive = scene.meshes[0].primitives[p];
    primitive.material = static_cast<uint32_t>(p);
    for (uint32_t i = 0; i < 3000; ++i) {
      Vertex vertex;
      vertex.position_ls =
          p == 1 ? scene.meshes[0].primitives[0].vertices[i].position_ls
                 : glm::vec3(between(random, -size, size), between(random, 0, size), between(random, 5, 6));
      vertex.normal_ls = direction(random);
      vertex.tangent_ls = glm::vec4(direction(random), random() % 2 ? 1 : -1);
      vertex.uv0 = {between(random, -3, 3), between(random, 0, 1)};
      vertex.uv1 = {between(random, 0, 100), between(random, 0, 1)};
      primitive.vertices.push_back(vertex);
      primitive.indices.push_back(i);
    }
  }
  MeshInstance instance;
  instance.world_from_local = glm::dmat4(1);
  instance.world_from_local[0] = {3, 1, 0, 0};  // sheared and stretched
  instance.world_from_local[3] = {7, 8, 9, 1};
  scene.instances = {instance};
  return scene;
}

double angle(const glm::vec3& a, const glm::vec3& b) {
  return std::atan2(glm::length(glm::cross(glm::dvec3(a), glm::dvec3(b))), glm::dot(glm::dvec3(a), glm::dvec3(b)));
}

TEST(Quantize, KeepsTheErrorsThatItStates) {
  std::mt19937 random(5);
  for (const float size : {0.5f, 20.0f, 3000.0f}) {
    for (const int bits : {8, 10, 16}) {
      const Scene before = random_scene(random, size);
      Scene scene = before;
      pack::BakeInfo info;
      const QuantizeSettings settings{.position_error_m = 0.002f, .normal_bits = bits, .uv_bits = 12};
      const std::vector<PackedMesh> meshes = quantize(scene, settings, info);
      double distance = 0, turned = 0, uv = 0;
      const glm::dmat4& world = before.instances[0].world_from_local;
      for (size_t p = 0; p < 2; ++p) {
        for (size_t i = 0; i < 3000; ++i) {
          const Vertex& in = before.meshes[0].primitives[p].vertices[i];
          const PackedVertex& out = meshes[0].primitives[p].vertices[i];
          distance = std::max(
              distance, glm::distance(world * glm::dvec4(in.position_ls, 1), world * glm::dvec4(out.position_ls, 1)));
          turned = std::max(turned, angle(in.normal_ls, pack::decode_normal(out.attributes.normal_ls)));
          if (p == 1) continue;
          const glm::vec4 tangent = pack::decode_tangent(out.attributes.tangent_ls);
          EXPECT_EQ(tangent.w, in.tangent_ls.w);
          turned = std::max(turned, angle(in.tangent_ls, tangent));
          for (int k = 0; k < 2; ++k) {
            uv = std::max({uv, std::abs(double{in.uv0[k]} - out.attributes.uv0[k]),
                           std::abs(double{in.uv1[k]} - out.attributes.uv1[k])});
          }
        }
      }
      EXPECT_LE(distance, info.position_error_m);
      EXPECT_LE(info.position_error_m, settings.position_error_m);
      EXPECT_GT(distance, 0.2 * info.position_error_m);  // and what is stated was measured
      EXPECT_LE(turned, info.normal_error_rad + 1e-6);
      EXPECT_GE(turned, info.normal_error_rad - 1e-6);
      EXPECT_LE(info.normal_error_rad, 4.3 / (1 << bits) + 1e-4);
      EXPECT_LE(uv, info.uv_error);
      EXPECT_LE(info.uv_error, 0.5 / 4096 * (1 + 1e-6));
      EXPECT_GT(uv, 0.4 / 4096);
    }
  }
}

TEST(Quantize, KeepsItsErrorInTheImageWhateverTheTransform) {
  std::mt19937 random(11);
  for (const float scale : {0.25f, 1.0f, 3.0f, 64.0f, 1e9f}) {
    Scene before = random_scene(random, 4);
    TextureUse& use = before.materials[0].base_color;  // of uv1; the normal map's uv0 is as it is
    use.uv_transform = {glm::vec3(0.6f * scale, 0.8f * scale, 5), glm::vec3(-0.8f * scale, 0.6f * scale, 7)};
    Scene scene = before;
    pack::BakeInfo info;
    const std::vector<PackedMesh> meshes = quantize(scene, {.uv_bits = 12}, info);
    double uv0 = 0, uv1 = 0;
    for (size_t i = 0; i < 3000; ++i) {
      const Vertex& in = before.meshes[0].primitives[0].vertices[i];
      const pack::VertexAttributes& out = meshes[0].primitives[0].vertices[i].attributes;
      const glm::dvec2 off = glm::dvec2(out.uv1) - glm::dvec2(in.uv1);
      for (const glm::vec3& row : use.uv_transform) uv1 = std::max(uv1, std::abs(row.x * off.x + row.y * off.y));
      for (int k = 0; k < 2; ++k) uv0 = std::max(uv0, std::abs(double{out.uv0[k]} - in.uv0[k]));
    }
    EXPECT_LE(std::max(uv0, uv1), info.uv_error) << scale;
    EXPECT_LE(info.uv_error, 0.5 / 4096 * (1 + 1e-6)) << scale;
    EXPECT_GT(uv0, 0.4 / 4096) << scale;  // which another set's transform makes no finer
    if (scale == 64) {
      EXPECT_GT(uv1, 0.1 / 4096);
    }
  }
}

TEST(Quantize, MovesSharedPlacesTogetherAndLeavesOutWhatNothingReads) {
  std::mt19937 random(6);
  Scene scene = random_scene(random, 4);
  pack::BakeInfo info;
  const std::vector<PackedMesh> meshes = quantize(scene, {}, info);
  const std::vector<PackedPrimitive>& primitives = meshes.at(0).primitives;
  for (size_t i = 0; i < 3000; ++i) {
    EXPECT_EQ(primitives[0].vertices[i].position_ls, primitives[1].vertices[i].position_ls);
    EXPECT_EQ(primitives[1].vertices[i].attributes.uv0, glm::vec2(0));
    EXPECT_EQ(primitives[1].vertices[i].attributes.uv1, glm::vec2(0));
    EXPECT_EQ(primitives[1].vertices[i].attributes.tangent_ls, 0u);
  }
  EXPECT_TRUE(scene.meshes[0].primitives.empty());
}

TEST(Quantize, KeepsFloatsWhereItIsTold) {
  std::mt19937 random(8);
  const Scene before = random_scene(random, 4);
  Scene scene = before;
  pack::BakeInfo info;
  const std::vector<PackedMesh> meshes =
      quantize(scene, {.position_error_m = 0, .normal_bits = 16, .uv_bits = 0}, info);
  EXPECT_EQ(info.position_error_m, 0);
  EXPECT_EQ(info.uv_error, 0);
  for (size_t i = 0; i < 3000; ++i) {
    EXPECT_EQ(meshes[0].primitives[0].vertices[i].position_ls, before.meshes[0].primitives[0].vertices[i].position_ls);
    EXPECT_EQ(meshes[0].primitives[0].vertices[i].attributes.uv0, before.meshes[0].primitives[0].vertices[i].uv0);
  }
}

TEST(Quantize, DropsMeshesThatNothingShows) {
  std::mt19937 random(9);
  Scene scene = random_scene(random, 4);
  scene.instances.clear();
  pack::BakeInfo info;
  EXPECT_TRUE(quantize(scene, {}, info).at(0).primitives.empty());
}

TEST(GridStep, IsTheLargestPowerOfTwoThatKeepsTheError) {
  for (const double error : {0.0005, 0.01, 0.3}) {
    for (const double scale : {0.001, 1.0, 17.0}) {
      const double step = grid_step(error, scale, 1e9);
      EXPECT_EQ(std::exp2(std::round(std::log2(step))), step);
      EXPECT_LE(step * std::sqrt(3) / 2 * scale, error);
      EXPECT_GT(2 * step * std::sqrt(3) / 2 * scale, error * (1 - 1e-5));
    }
  }
  EXPECT_EQ(grid_step(0.0005, 1, 0.5), std::exp2(-15));  // at least 16384 steps along the longest side
  EXPECT_EQ(grid_step(0.0005, 1, 0), 0);                 // a point
}

TEST(LargestScale, IsTheLongestThatAUnitVectorBecomes) {
  std::mt19937 random(4);
  for (int round = 0; round < 200; ++round) {
    glm::dmat4 matrix(1);
    for (int i = 0; i < 3; ++i) matrix[i] = glm::dvec4(direction(random) * between(random, 0.001, 100), 0);
    const double scale = largest_scale(matrix);
    double longest = 0;
    glm::dvec3 v = direction(random);
    for (int i = 0; i < 3000; ++i) {  // power iteration
      v = glm::normalize(glm::transpose(glm::dmat3(matrix)) * (glm::dmat3(matrix) * v));
      longest = std::max(longest, glm::length(glm::dmat3(matrix) * v));
    }
    EXPECT_NEAR(scale / longest, 1, 1e-5);
    EXPECT_GE(scale, longest * (1 - 1e-12));
  }
  EXPECT_DOUBLE_EQ(largest_scale(glm::dmat4(2.5)), 2.5);
}

TEST(Quantize, HasTheSameBytesOnAnyNumberOfThreads) {
  std::vector<PackedVertex> bytes[2];
  pack::BakeInfo infos[2];
  for (const size_t threads : {1u, 2u}) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    std::mt19937 random(10);
    Scene scene = random_scene(random, 7);
    bytes[threads - 1] = quantize(scene, {}, infos[threads - 1]).at(0).primitives[0].vertices;
  }
  EXPECT_EQ(std::memcmp(bytes[0].data(), bytes[1].data(), bytes[0].size() * sizeof(PackedVertex)), 0);
  EXPECT_EQ(infos[0].normal_error_rad, infos[1].normal_error_rad);
}

}  // namespace
}  // namespace chandelier::baker::test
