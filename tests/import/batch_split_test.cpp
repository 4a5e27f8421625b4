// SPDX-License-Identifier: Apache-2.0
// Splitting into batches, putting them in order, and their normal cones against eyes anywhere.
#include "bake/batch_split.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>

#include "bake/batch_cone.h"
#include "bake/batch_cut.h"

namespace chandelier::baker::test {
namespace {

float between(std::mt19937& random, double low, double high) {
  return static_cast<float>(low + (high - low) * (static_cast<double>(random()) / 4294967296.0));
}

std::vector<BvhItem> random_boxes(std::mt19937& random, uint32_t count) {
  std::vector<BvhItem> boxes;
  for (uint32_t i = 0; i < count; ++i) {
    glm::vec3 corners[3];
    const glm::vec3 at(between(random, -9, 9), between(random, 0, 2), between(random, 0, 40));
    for (glm::vec3& corner : corners) corner = at + glm::vec3(between(random, 0, 0.2), between(random, 0, 0.2), 0);
    boxes.push_back(triangle_box(corners[0], corners[1], corners[2], i));
  }
  return boxes;
}

void expect_all_once(const BatchOrder& order, size_t count, size_t most) {
  std::vector<uint32_t> sorted = order.triangles;
  std::sort(sorted.begin(), sorted.end());
  ASSERT_EQ(sorted.size(), count);
  for (uint32_t i = 0; i < count; ++i) ASSERT_EQ(sorted[i], i);
  EXPECT_EQ(std::accumulate(order.counts.begin(), order.counts.end(), size_t{0}), count);
  for (const uint32_t each : order.counts) EXPECT_TRUE(each >= 1 && each <= most) << each;
}

TEST(BatchSplit, TakesEachTriangleOnceIntoNearlyFullBatches) {
  std::mt19937 random(1);
  for (const uint32_t count : {1u, 3u, 4u, 5u, 100u, 101u, 199u, 1000u, 70000u}) {
    for (const size_t most : {4u, 100u, 512u}) {
      const BatchOrder order = split_into_batches(random_boxes(random, count), most);
      expect_all_once(order, count, most);
      EXPECT_LE(static_cast<double>(order.counts.size()), std::ceil(1.35 * std::ceil(double(count) / double(most))));
    }
  }
  EXPECT_TRUE(split_into_batches({}, 100).triangles.empty());
}

TEST(BatchSplit, EndsWhateverTheBoxes) {
  std::mt19937 random(2);
  const auto all = [](uint32_t count, auto corner) {
    std::vector<BvhItem> boxes;
    for (uint32_t i = 0; i < count; ++i) {
      const glm::vec3 p = corner(i);
      boxes.push_back(triangle_box(p, p, p, i));
    }
    return boxes;
  };
  // All in one place; at distances that double; beyond the squares of floats; all but one in one place.
  expect_all_once(split_into_batches(all(5000, [](auto) { return glm::vec3(1, 2, 3); }), 100), 5000, 100);
  expect_all_once(
      split_into_batches(all(5000, [](auto i) { return glm::vec3(std::ldexp(1.0f, int(i % 250) - 125)); }), 100), 5000,
      100);
  expect_all_once(split_into_batches(all(5000, [&](auto) { return glm::vec3(between(random, -3e38, 3e38)); }), 100),
                  5000, 100);
  expect_all_once(split_into_batches(all(5000, [](auto i) { return glm::vec3(i == 17 ? 1e30f : 0); }), 100), 5000, 100);
}

TEST(BatchSplit, IsTheSameOnAnyNumberOfThreads) {
  BatchOrder orders[2];
  for (const size_t threads : {1u, 2u}) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    std::mt19937 random(3);
    orders[threads - 1] = split_into_batches(random_boxes(random, 200000), 100);
  }
  EXPECT_EQ(orders[0].triangles, orders[1].triangles);
  EXPECT_EQ(orders[0].counts, orders[1].counts);
}

/// A bumpy sheet of squares, two triangles each.
PackedPrimitive sheet(uint32_t side) {
  PackedPrimitive out;
  for (uint32_t y = 0; y <= side; ++y) {
    for (uint32_t x = 0; x <= side; ++x) {
      const auto fx = static_cast<float>(x), fy = static_cast<float>(y);
      out.vertices.push_back({.position_ls = {fx, fy, std::sin(fx * 0.5f) * std::cos(fy * 0.3f)}, .attributes = {}});
    }
  }
  for (uint32_t y = 0; y < side; ++y) {
    for (uint32_t x = 0; x < side; ++x) {
      const uint32_t a = y * (side + 1) + x, b = a + 1, c = a + side + 1;
      for (const uint32_t corner : {a, b, c + 1, a, c + 1, c}) out.indices.push_back(corner);
    }
  }
  out.closed.assign(out.triangle_count(), false);
  return out;
}

TEST(BatchCut, PutsClosedTrianglesFirstAndVerticesInTheOrderOfTheirUse) {
  std::mt19937 random(4);
  PackedPrimitive primitive = sheet(40);
  for (size_t t = 0; t < primitive.closed.size(); ++t) primitive.closed[t] = t % 40 < 20;
  primitive.skin_vertices.resize(primitive.vertices.size());
  const PackedPrimitive before = primitive;
  const CutPrimitive cut = cut_into_batches(std::move(primitive), 64);
  ASSERT_EQ(cut.indices.size(), before.indices.size());
  EXPECT_EQ(cut.skin_vertices.size(), cut.vertices.size());
  uint32_t next = 0;  // the lowest number of a vertex that was not used yet
  std::vector<std::array<uint32_t, 3>> triangles[2], expected[2];
  const auto turned = [](std::array<uint32_t, 3> t) {
    std::rotate(t.begin(), std::min_element(t.begin(), t.end()), t.end());
    return t;
  };
  size_t i = 0;
  for (size_t b = 0; b < cut.batch_counts.size(); ++b) {
    for (uint32_t t = 0; t < cut.batch_counts[b]; ++t, i += 3) {
      std::array<uint32_t, 3> corners;
      for (size_t c = 0; c < 3; ++c) {
        ASSERT_LE(cut.indices[i + c], next);
        next = std::max(next, cut.indices[i + c] + 1);
        corners[c] = cut.vertex_order[cut.indices[i + c]];
      }
      triangles[b < cut.closed_batches].push_back(turned(corners));
    }
  }
  EXPECT_EQ(next, cut.vertex_order.size());
  for (size_t t = 0; t < before.triangle_count(); ++t) {
    const uint32_t* corner = &before.indices[3 * t];
    expected[before.closed[t]].push_back(turned({corner[0], corner[1], corner[2]}));
  }
  for (const int closed : {0, 1}) {
    std::sort(triangles[closed].begin(), triangles[closed].end());
    std::sort(expected[closed].begin(), expected[closed].end());
    EXPECT_EQ(triangles[closed], expected[closed]);
  }
}

bool shows_its_front(const glm::vec3* corner, const glm::dvec3& eye) {
  const glm::dvec3 a = corner[0];
  const glm::dvec3 normal = glm::cross(glm::dvec3(corner[1]) - a, glm::dvec3(corner[2]) - a);
  return glm::dot(normal, eye - a) > 0;
}

TEST(NormalCone, CullsNoEyeThatSeesAFront) {
  std::mt19937 random(5);
  size_t culled = 0, all_backs = 0, cones = 0;
  for (int round = 0; round < 400; ++round) {
    // A cap of a wavy sheet, far from the origin or near it; turned over every other round, as mirrored copies are.
    const glm::vec3 at(between(random, -500, 500), between(random, -5, 5), 0);
    const float waves = between(random, 0, 0.7), size = between(random, 0.01, 3);
    std::vector<glm::vec3> corners;
    for (int t = 0; t < 50; ++t) {
      const glm::vec3 place(between(random, -1, 1), between(random, -1, 1), 0);
      glm::vec3 corner[3];
      for (int c = 0; c < 3; ++c) {
        corner[c] = place + glm::vec3(0.1 * std::cos(c * 2 * M_PI / 3), 0.1 * std::sin(c * 2 * M_PI / 3), 0);
        corner[c].z = waves * (std::sin(3 * corner[c].x) + std::sin(2 * corner[c].y));
        corner[c] = at + size * corner[c];
      }
      if (round % 2) std::swap(corner[1], corner[2]);
      corners.insert(corners.end(), corner, corner + 3);
    }
    const NormalCone cone = normal_cone(corners);
    cones += cone.cutoff < 1;
    if (cone.cutoff < 1) {
      EXPECT_NEAR(glm::length(cone.axis), 1, 1e-5);
    }
    if (cone.cutoff == 1) {
      EXPECT_EQ(cone.axis, glm::vec3(0));
    }
    for (int e = 0; e < 300; ++e) {
      const glm::vec3 eye =
          at + size * 4.0f * glm::vec3(between(random, -1, 1), between(random, -1, 1), between(random, -1, 1));
      bool front = false;
      for (size_t i = 0; i < corners.size(); i += 3) front = front || shows_its_front(&corners[i], eye);
      const bool culls = cone.cutoff < 1 && glm::dot(glm::normalize(cone.apex - eye), cone.axis) >= cone.cutoff;
      EXPECT_FALSE(culls && front) << "round " << round;
      culled += culls;
      all_backs += !front;
    }
  }
  EXPECT_GT(cones, 200u);
  EXPECT_GT(culled, all_backs / 2);  // and it is of use
}

TEST(NormalCone, OfAClosedSurfaceNeverCulls) {
  const glm::vec3 p[4] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  const std::vector<glm::vec3> corners = {p[0], p[2], p[1], p[0], p[1], p[3], p[0], p[3], p[2], p[1], p[2], p[3]};
  EXPECT_EQ(normal_cone(corners).cutoff, 1);
}

}  // namespace
}  // namespace chandelier::baker::test
