// SPDX-License-Identifier: Apache-2.0
// Bounds of lights against samples of what they reach; the light hierarchy against a look at every light.
#include "bake/light_bvh.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <fstream>
#include <random>

#include "bake/light_bounds.h"
#include "gltf_builder.h"
#include "pack_checks.h"

namespace chandelier::baker::test {
namespace {

constexpr double pi = 3.14159265358979323846;

double length2(const glm::dvec3& v) {
  return glm::dot(v, v);
}

pack::Light spot_light(float half_angle_rad, float range_m, const glm::vec3& direction) {
  pack::Light light;
  light.type = pack::LightType::spot;
  light.position_ws = {3, -2, 7};
  light.direction_ws = glm::normalize(direction);
  light.range_m = range_m;
  light.outer_cone_cos = std::cos(half_angle_rad);
  return light;
}

/// Points of the tip and the cap of a spot light's sector, the rim among them: whatever holds these holds the sector.
std::vector<glm::dvec3> samples_of(const pack::Light& light) {
  const glm::dvec3 axis(light.direction_ws);
  const glm::dvec3 side =
      glm::normalize(glm::cross(axis, std::abs(axis.x) < 0.5 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0)));
  const glm::dvec3 other = glm::cross(axis, side);
  std::vector<glm::dvec3> out = {glm::dvec3(light.position_ws)};
  constexpr int rings = 200, step_count = 128;
  for (int ring = 0; ring <= rings; ++ring) {
    const double angle = std::acos(double{light.outer_cone_cos}) * ring / rings;
    for (int step = 0; step < step_count; ++step) {
      const double turn = 2 * pi * step / step_count;
      const glm::dvec3 way =
          axis * std::cos(angle) + (side * std::cos(turn) + other * std::sin(turn)) * std::sin(angle);
      out.push_back(glm::dvec3(light.position_ws) + way * double{light.range_m});
    }
  }
  return out;
}

TEST(LightBounds, AreTheSmallestSphereAroundASpotLightsSector) {
  for (const double degrees : {0.5, 10.0, 30.0, 44.0, 45.0, 46.0, 60.0, 80.0, 90.0, 120.0, 180.0}) {
    SCOPED_TRACE(degrees);
    const pack::Light light = spot_light(static_cast<float>(degrees * pi / 180), 5, {1, -2, 0.5});
    const Sphere bounds = light_bounds(light);
    const std::vector<glm::dvec3> points = samples_of(light);
    double farthest = 0;
    glm::dvec3 least(0);  // of the steps to spheres nearby: is any of them smaller?
    for (const glm::dvec3& point : points) farthest = std::max(farthest, glm::distance(point, bounds.center));
    EXPECT_LE(farthest, bounds.radius * (1 + 1e-6));
    EXPECT_GE(farthest, bounds.radius * (1 - 1e-3));
    for (const double step : {0.5, 0.05, 0.01}) {
      for (int i = 0; i < 27; ++i) {
        const glm::dvec3 moved = bounds.center + step * glm::dvec3(i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1);
        double radius2 = 0;
        for (const glm::dvec3& point : points) radius2 = std::max(radius2, length2(point - moved));
        EXPECT_GE(std::sqrt(radius2), bounds.radius * (1 - 1e-3)) << step << " " << i;
      }
    }
  }
}

TEST(LightBounds, OfAPointLightAreItsRange) {
  pack::Light light;
  light.position_ws = {0.1f, 1e6f, -3};
  light.range_m = 0.3f;
  const FloatSphere bounds = rounded_outwards(light_bounds(light));
  EXPECT_EQ(bounds.center, light.position_ws);
  EXPECT_EQ(bounds.radius, light.range_m);
}

TEST(LightBounds, RoundOutwardsAndStayFinite) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> number(-1e3, 1e3);
  for (int i = 0; i < 1000; ++i) {
    const Sphere sphere{{number(random), number(random), number(random)}, std::abs(number(random))};
    const FloatSphere rounded = rounded_outwards(sphere);
    EXPECT_GE(double{rounded.radius}, sphere.radius + glm::distance(sphere.center, glm::dvec3(rounded.center)));
  }
  const FloatSphere huge = rounded_outwards({{1e39, 0, -1e39}, 1e39});
  EXPECT_TRUE(std::isfinite(huge.center.x) && std::isfinite(huge.radius));
}

/// Lights as a scene may have them: lamps in rooms along streets, a few floodlights, some at the same place, a sun.
std::vector<pack::Light> many_lights(size_t count, uint32_t seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> place(-100, 100), range(1, 6), one(0, 1);
  std::vector<pack::Light> lights(count);
  for (size_t i = 0; i < count; ++i) {
    pack::Light& light = lights[i];
    if (i % 50 == 49) light.type = pack::LightType::directional;
    light.position_ws = {place(random), 0.1f * place(random), place(random)};
    light.range_m = one(random) < 0.02f ? 40.0f : range(random);
    if (i % 7 == 6) light.position_ws = lights[i - 1].position_ws;
    light.bounds_center_ws = light.position_ws;
    light.bounds_radius_m = light.range_m;
  }
  return lights;
}

bool holds(const glm::vec3& center, float radius, const glm::vec3& point) {
  return length2(glm::dvec3(point) - glm::dvec3(center)) <= double{radius} * radius;
}

/// As a shader walks it. `visited` counts nodes.
std::vector<uint32_t> lights_at(const std::vector<pack::LightBvhNode>& nodes, const glm::vec3& point, size_t& visited) {
  std::vector<uint32_t> found;
  for (size_t i = 0; i < nodes.size(); ++visited) {
    const bool hit = holds(nodes[i].center_ws, nodes[i].radius_m, point);
    if (hit && nodes[i].light != pack::none) found.push_back(nodes[i].light);
    i = hit ? i + 1 : nodes[i].miss;
  }
  std::sort(found.begin(), found.end());
  return found;
}

std::vector<uint32_t> lights_by_looking_at_all(const std::vector<pack::Light>& lights, const glm::vec3& point) {
  std::vector<uint32_t> found;
  for (uint32_t i = 0; i < lights.size(); ++i) {
    if (lights[i].type == pack::LightType::directional) continue;
    if (holds(lights[i].bounds_center_ws, lights[i].bounds_radius_m, point)) found.push_back(i);
  }
  return found;
}

TEST(LightBvh, FindsExactlyTheLightsThatReachAPoint) {
  for (const size_t count : {1u, 2u, 3u, 10u, 471u, 5000u}) {
    SCOPED_TRACE(count);
    const std::vector<pack::Light> lights = many_lights(count, static_cast<uint32_t>(count));
    const std::vector<pack::LightBvhNode> nodes = build_light_bvh(lights);
    std::mt19937 random(7);
    std::uniform_real_distribution<float> place(-110, 110);
    size_t visited = 0, found = 0;
    constexpr int point_count = 2000;
    for (int i = 0; i < point_count; ++i) {
      const glm::vec3 point = {place(random), 0.1f * place(random), place(random)};
      const auto expected = lights_by_looking_at_all(lights, point);
      ASSERT_EQ(lights_at(nodes, point, visited), expected);
      found += expected.size();
    }
    RecordProperty("visited_per_point_" + std::to_string(count), static_cast<int>(visited / point_count));
    EXPECT_TRUE(count < 471 || visited < count * point_count / 4) << visited;  // of 2 · count nodes
    EXPECT_TRUE(count < 471 || found > 0u);
  }
}

TEST(LightBvh, KeepsThePromisesOfThePack) {
  for (const size_t count : {0u, 1u, 2u, 471u, 20000u}) {
    pack::Contents pack;
    pack.lights = many_lights(count, 3);
    for (pack::Light& light : pack.lights) light.direction_ws = {0, 0, -1};
    pack.bake_info.batch_triangles = 100;
    pack.light_bvh = build_light_bvh(pack.lights);
    const size_t placed = count - count / 50;
    EXPECT_EQ(pack.light_bvh.size(), placed ? 2 * placed - 1 : 0);
    EXPECT_EQ(pack::check(pack::view_of(pack)), "");  // links, and each light in one leaf
  }
}

TEST(LightBvh, HoldsManyLightsInOnePlaceAndInARow) {
  std::vector<pack::Light> lights(3000);
  float x = 1e-30f;  // each three times as far as the one before, again and again: the most uneven splits
  for (size_t i = 0; i < lights.size(); ++i, x = x < 1e30f ? x * 3 : 1e-30f) {
    lights[i].bounds_center_ws = i % 3 ? glm::vec3(x, 0, 0) : glm::vec3(0);
    lights[i].bounds_radius_m = i % 2 ? 0.0f : 1.0f;
  }
  const std::vector<pack::LightBvhNode> nodes = build_light_bvh(lights);
  size_t visited = 0;
  EXPECT_EQ(lights_at(nodes, glm::vec3(0), visited), lights_by_looking_at_all(lights, glm::vec3(0)));
}

TEST(LightBvh, IsTheSameOnAnyNumberOfThreads) {
  const std::vector<pack::Light> lights = many_lights(20000, 11);
  std::vector<pack::LightBvhNode> first;
  for (const size_t threads : {1u, 2u, 7u}) {
    const tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
    const std::vector<pack::LightBvhNode> nodes = build_light_bvh(lights);
    if (first.empty()) first = nodes;
    ASSERT_EQ(nodes.size(), first.size());
    EXPECT_EQ(std::memcmp(nodes.data(), first.data(), nodes.size() * sizeof(nodes[0])), 0);
  }
}

}  // namespace
}  // namespace chandelier::baker::test
