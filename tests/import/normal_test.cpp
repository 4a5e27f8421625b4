// SPDX-License-Identifier: Apache-2.0
// Missing normals: flat, smooth up to an angle, against walking all pairs of neighbours.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "bake/normals.h"

namespace chandelier::baker::test {
namespace {

/// Each triangle with vertices of its own.
Primitive soup(const std::vector<glm::vec3>& places, const std::vector<uint32_t>& corners) {
  Primitive primitive;
  for (const uint32_t corner : corners) {
    primitive.indices.push_back(static_cast<uint32_t>(primitive.vertices.size()));
    primitive.vertices.push_back({.position_ls = places[corner]});
  }
  return primitive;
}

glm::vec3 normal_at(const Primitive& primitive, size_t corner) {
  return primitive.vertices[primitive.indices[corner]].normal_ls;
}

/// Two unit squares that share the edge x = y = 0 along z, the second turned by `angle` from flat; two triangles each.
Primitive bent(float angle_rad) {
  const float c = std::cos(angle_rad), s = std::sin(angle_rad);
  return soup({{-1, 0, 0}, {-1, 0, 1}, {0, 0, 0}, {0, 0, 1}, {c, -s, 0}, {c, -s, 1}},
              {0, 1, 2, 2, 1, 3, 2, 3, 4, 4, 3, 5});
}

TEST(Normals, AreFlatByDefault) {
  Primitive primitive = bent(0.1f);
  make_normals(primitive, 0);
  for (size_t i = 0; i < 12; ++i) {
    const glm::vec3 expected = i < 6 ? glm::vec3(0, 1, 0) : glm::vec3(std::sin(0.1f), std::cos(0.1f), 0);
    EXPECT_LT(glm::distance(normal_at(primitive, i), expected), 1e-6f) << i;
  }
}

TEST(Normals, AreSmoothAcrossAnEdgeUpToTheAngle) {
  for (const float angle : {0.1f, 0.5f, 1.0f}) {
    for (const float smooth : {0.05f, 0.3f, 0.7f, 1.5f}) {
      Primitive primitive = bent(angle);
      make_normals(primitive, smooth);
      // On the shared edge the two sides weigh the same: each has 90 degrees at either end of it.
      const bool smoothed = angle < smooth;
      for (const size_t corner : {2u, 3u, 5u, 6u, 7u, 10u}) {
        const float turned = smoothed ? angle / 2 : corner < 6 ? 0 : angle;
        EXPECT_LT(glm::distance(normal_at(primitive, corner), {std::sin(turned), std::cos(turned), 0}), 1e-6f)
            << angle << " " << smooth << " " << corner;
      }
      EXPECT_LT(glm::distance(normal_at(primitive, 0), {0, 1, 0}), 1e-6f);
    }
  }
}

TEST(Normals, OfAFineSphereAreItsRadii) {
  constexpr int rings = 24, sides = 48;
  std::vector<glm::vec3> places;
  for (int r = 0; r <= rings; ++r) {
    for (int s = 0; s < sides; ++s) {
      const double theta = M_PI * r / rings, phi = 2 * M_PI * s / sides;
      const double radius = r % rings == 0 ? 0 : std::sin(theta);  // the poles are one place each
      places.push_back(glm::dvec3(radius * std::cos(phi), std::cos(theta), radius * std::sin(phi)));
    }
  }
  std::vector<uint32_t> corners;
  for (uint32_t r = 0; r < rings; ++r) {
    for (uint32_t s = 0; s < sides; ++s) {
      const uint32_t a = r * sides + s, b = r * sides + (s + 1) % sides, c = a + sides, d = b + sides;
      if (r > 0) corners.insert(corners.end(), {a, b, c});
      if (r + 1 < rings) corners.insert(corners.end(), {b, d, c});
    }
  }
  Primitive primitive = soup(places, corners);
  make_normals(primitive, 1.0f);
  float worst = 1;
  for (size_t i = 0; i < primitive.indices.size(); ++i) {
    const glm::vec3 place = primitive.vertices[primitive.indices[i]].position_ls;
    worst = std::min(worst, glm::dot(normal_at(primitive, i), place));
  }
  EXPECT_GT(worst, 0.999f);
}

TEST(Normals, OfAFanSmoothInOneSector) {
  // A cone of many sides: quadratic work at its tip would not end.
  constexpr int sides = 100000;
  std::vector<glm::vec3> places = {{0, 0.1f, 0}};
  std::vector<uint32_t> corners;
  for (int i = 0; i < sides; ++i) {
    const double angle = 2 * M_PI * i / sides;
    places.push_back({std::cos(angle), 0, -std::sin(angle)});
    const auto a = static_cast<uint32_t>(i);
    corners.insert(corners.end(), {0, a + 1, (a + 1) % sides + 1});
  }
  Primitive primitive = soup(places, corners);
  make_normals(primitive, 0.5f);
  for (size_t i = 0; i < primitive.indices.size(); i += 3) {
    ASSERT_LT(glm::distance(normal_at(primitive, i), {0, 1, 0}), 1e-4f);
  }
}

TEST(Normals, KeepEachTriangleOfAnyHeapInItsOrder) {
  std::mt19937 random(7);
  for (int round = 0; round < 200; ++round) {
    // A dozen places and more triangles than a manifold can have over them; some repeat a place, some repeat others.
    std::vector<glm::vec3> places;
    for (int i = 0; i < 12; ++i) {
      places.push_back(
          {static_cast<float>(random() % 4), static_cast<float>(random() % 4), static_cast<float>(random() % 4)});
    }
    std::vector<uint32_t> corners;
    for (int i = 0; i < 3 * 60; ++i) corners.push_back(static_cast<uint32_t>(random() % places.size()));
    Primitive primitive = soup(places, corners);
    primitive.skin_vertices.resize(primitive.vertices.size());
    for (size_t i = 0; i < corners.size(); ++i) {
      primitive.skin_vertices[i].joints[0] = static_cast<uint16_t>(corners[i]);
    }
    make_normals(primitive, static_cast<float>(round % 4) * 0.7f);
    ASSERT_EQ(primitive.indices.size(), corners.size());
    ASSERT_EQ(primitive.skin_vertices.size(), primitive.vertices.size());
    for (size_t i = 0; i < corners.size(); ++i) {
      EXPECT_EQ(primitive.vertices[primitive.indices[i]].position_ls, places[corners[i]]);
      EXPECT_EQ(primitive.skin_vertices[primitive.indices[i]].joints[0], corners[i]);
      EXPECT_NEAR(glm::length(normal_at(primitive, i)), 1, 1e-5);
    }
  }
}

}  // namespace
}  // namespace chandelier::baker::test
