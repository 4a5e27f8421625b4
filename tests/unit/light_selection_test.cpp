// SPDX-License-Identifier: Apache-2.0
// The selection of light clusters equals brute force bit for bit, whatever the lights.
#include <gtest/gtest.h>

#include <random>

#include "brute_force_selection.h"
#include "lights/cluster_counter.h"
#include "lights/point_tree.h"

namespace chandelier::lights {
namespace {

class Random {
 public:
  explicit Random(uint32_t seed) : bits_(seed) {}
  uint32_t below(uint32_t count) { return static_cast<uint32_t>(bits_() % count); }
  bool once_in(uint32_t count) { return below(count) == 0; }
  float uniform(float from, float to) { return from + (to - from) * static_cast<float>(bits_() >> 8) * 0x1p-24f; }
  glm::vec3 in_box(float half_side) {
    const float x = uniform(-half_side, half_side), y = uniform(-half_side, half_side);
    return {x, y, uniform(-half_side, half_side)};
  }
  // Multiples of a quarter: many distances are equal, or exactly d_min.
  glm::vec3 on_lattice(uint32_t side) { return 0.25f * glm::vec3(below(side), below(side), below(side)); }
  glm::vec3 direction() {
    constexpr glm::vec3 axes[]{{1, 0, 0}, {0, -1, 0}, {0, 0, 1}};
    return once_in(3) ? axes[below(3)] : glm::normalize(in_box(1) + glm::vec3(0, 0, 1e-3f));
  }

 private:
  std::mt19937 bits_;
};

// Where all lights of a set stand.
enum class Layout : uint32_t { room, lattice, clumps, huge, tiny, strewn, count };

glm::vec3 position(Random& random, Layout layout) {
  switch (layout) {
    case Layout::lattice:
      return random.on_lattice(12);
    case Layout::clumps:
      return 10.0f * random.on_lattice(5) + random.in_box(0.1f);
    case Layout::huge:  // whose differences and squares exceed what a float holds
      return random.in_box(1.0f) * (random.once_in(2) ? 3.4e38f : 1e25f);
    case Layout::tiny:  // whose squares are less than what a float holds
      return random.in_box(1.0f) * (random.once_in(2) ? 1e-38f : 1e-22f);
    case Layout::strewn:
      return random.in_box(1.0f) * std::exp2(random.uniform(-10, 60));
    default:
      return random.in_box(10.0f);
  }
}

ClusterLight random_light(Random& random, Layout layout) {
  ClusterLight light{position(random, layout), random.uniform(0.5f, 8.0f)};
  if (random.once_in(3)) light.range_m = static_cast<float>(random.below(3));
  if (random.once_in(50)) light.range_m = 3e38f;
  if (random.once_in(3)) {
    light.axis_ws = random.direction();
    light.cone_cos = std::cos(random.once_in(4) ? 1.6f : random.uniform(0.0f, 1.57f));
  }
  light.dynamic = random.once_in(6);
  light.unclustered = random.once_in(12);
  if (random.once_in(8)) light.group = 1 + random.below(4);
  if (random.once_in(5)) light.priority = 64 * random.below(4);
  return light;
}

float random_d_init(Random& random, Layout layout) {
  if (random.once_in(8)) return 0.0f;
  if (random.once_in(12)) return 3e38f;
  if (layout == Layout::lattice) return 0.25f * static_cast<float>(random.below(8));
  if (layout == Layout::huge) return random.uniform(0.0f, 1.0f) * 1e38f;
  if (layout == Layout::tiny) return random.uniform(0.0f, 1.0f) * 1e-22f;
  return std::exp2(random.uniform(-4, 4));
}

struct Case {
  std::vector<ClusterLight> lights;
  ClusterSettings settings;
  std::vector<uint32_t> previous_centers;
  Blocked blocked;
};

// Walls at random: the same for both lights of a pair.
Blocked random_walls(uint32_t seed, uint32_t once_in) {
  return [seed, once_in](uint32_t light, uint32_t center) {
    const uint64_t pair = uint64_t{std::min(light, center)} << 32 | std::max(light, center);
    return ((pair ^ seed) * 0x9E3779B97F4A7C15u >> 40) % once_in == 0;
  };
}

Case random_case(uint32_t seed, uint32_t most_lights) {
  Random random(seed);
  const auto layout = static_cast<Layout>(random.below(static_cast<uint32_t>(Layout::count)));
  Case drawn;
  const uint32_t count = random.below(most_lights + 1);
  for (uint32_t i = 0; i < count; ++i) {
    drawn.lights.push_back(random_light(random, layout));
    if (i > 0 && random.once_in(6)) drawn.lights[i].position_ws = drawn.lights[random.below(i)].position_ws;
    if (random.once_in(4)) drawn.lights[i].range_m = drawn.lights[0].range_m;
  }
  ClusterSettings& settings = drawn.settings;
  settings.camera_ws = random.once_in(3) && count > 0 ? drawn.lights[0].position_ws : position(random, layout);
  settings.d_init_m = random_d_init(random, layout);
  settings.z_far_m = std::exp2(random.uniform(-3, 6));
  settings.scaling = static_cast<DistanceScaling>(random.below(3));
  settings.dynamic_lights = static_cast<DynamicLights>(random.below(2));
  if (random.once_in(3)) {
    settings.stability = random.once_in(8) ? 0.0f : random.uniform(0.0f, 0.999f);
    for (uint32_t i = 0; i < count; ++i)  // some past the end, which counts as none
      drawn.previous_centers.push_back(random.once_in(2) ? i : random.once_in(4) ? no_center : random.below(count + 2));
  }
  if (random.once_in(3)) drawn.blocked = random_walls(seed, 1 + random.below(6));
  return drawn;
}

void expect_equal(const LightClusters& a, const LightClusters& b, uint32_t seed) {
  ASSERT_EQ(a.cluster_of_light, b.cluster_of_light) << "seed " << seed;
  ASSERT_EQ(a.clusters.size(), b.clusters.size()) << "seed " << seed;
  for (size_t c = 0; c < a.clusters.size(); ++c) {
    ASSERT_EQ(a.clusters[c].center, b.clusters[c].center) << "seed " << seed;
    ASSERT_EQ(a.clusters[c].d_min_m, b.clusters[c].d_min_m) << "seed " << seed;
    ASSERT_EQ(a.clusters[c].range_m, b.clusters[c].range_m) << "seed " << seed;
    ASSERT_EQ(a.clusters[c].spread_m, b.clusters[c].spread_m) << "seed " << seed;
    ASSERT_EQ(a.clusters[c].light_count, b.clusters[c].light_count) << "seed " << seed;
  }
}

// How many lights of all kinds there were, so that a generator gone astray is seen.
struct Met {
  uint32_t clusters = 0, members = 0, grouped = 0, blocked = 0, clinging = 0;
};

void compare_with_brute_force(uint32_t seed, uint32_t most_lights, Met& met) {
  Case drawn = random_case(seed, most_lights);
  drawn.settings.previous_centers = drawn.previous_centers;
  const LightClusters expected = brute_force_clusters(drawn.lights, drawn.settings, drawn.blocked);
  expect_equal(select_light_clusters(drawn.lights, drawn.settings, drawn.blocked), expected, seed);
  met.clusters += static_cast<uint32_t>(expected.clusters.size());
  met.members += static_cast<uint32_t>(drawn.lights.size() - expected.clusters.size());
  for (const ClusterLight& light : drawn.lights) met.grouped += light.group != 0;
  met.blocked += drawn.blocked ? 1 : 0;
  met.clinging += drawn.previous_centers.empty() ? 0 : 1;
}

TEST(LightSelectionTest, TenThousandSetsEqualBruteForce) {
  Met met;
  for (uint32_t seed = 0; seed < 10000 && !HasFatalFailure(); ++seed) compare_with_brute_force(seed, 100, met);
  EXPECT_GT(met.clusters, 100000u);
  EXPECT_GT(met.members, 100000u);
  EXPECT_GT(met.grouped, 20000u);
  EXPECT_GT(met.blocked, 2000u);
  EXPECT_GT(met.clinging, 2000u);
}

TEST(LightSelectionTest, LargeSetsEqualBruteForce) {
  Met met;
  for (uint32_t seed = 20000; seed < 20024 && !HasFatalFailure(); ++seed) compare_with_brute_force(seed, 2500, met);
  EXPECT_GT(met.members, 5000u);
}

void expect_counted(ClusterCounter& counter, const Case& drawn, float d_init_m, uint32_t seed) {
  ClusterSettings settings = drawn.settings;
  settings.d_init_m = d_init_m;
  const size_t clusters = select_light_clusters(drawn.lights, settings).clusters.size();
  ASSERT_EQ(counter.count(d_init_m, drawn.lights.size()), clusters) << "seed " << seed << ", d_init " << d_init_m;
  if (clusters > 0) {
    ASSERT_GT(counter.count(d_init_m, clusters - 1), clusters - 1) << "seed " << seed << ", d_init " << d_init_m;
  }
}

// Also where the counter remembers neighbours: from some d_init on down, twice, and exactly at it.
TEST(ClusterCounterTest, CountsTheClustersThatAreSelected) {
  for (uint32_t seed = 30000; seed < 33000 && !HasFatalFailure(); ++seed) {
    const Case drawn = random_case(seed, 100);
    ClusterCounter counter(drawn.lights, drawn.settings);
    for (const float part : {0.3f, 1.0f, 2.0f}) expect_counted(counter, drawn, part * drawn.settings.d_init_m, seed);
    for (const float largest : {1.0f, 0.6f}) {
      counter.stay_within(largest * drawn.settings.d_init_m);
      for (const float part : {0.4f, 1.0f, 0.0f, 0.9f})
        expect_counted(counter, drawn, part * largest * drawn.settings.d_init_m, seed);
    }
  }
}

TEST(PointTreeTest, VisitsAllWithinARadiusOnceAndHardlyMore) {
  for (uint32_t seed = 0; seed < 2000; ++seed) {
    Random random(seed);
    const auto layout = static_cast<Layout>(random.below(static_cast<uint32_t>(Layout::count)));
    std::vector<PointTree::Point> points(random.below(200));
    for (uint32_t i = 0; i < points.size(); ++i) points[i] = {position(random, layout), i};
    const glm::vec3 p = position(random, layout);
    const double radius = points.empty() ? 1.0 : straight_distance_m(points[0].position_ws, position(random, layout));
    std::vector<uint32_t> visits(points.size(), 0);
    PointTree(points).visit_near(p, SquaredRadius(radius), [&](uint32_t number) { ++visits[number]; });
    for (const PointTree::Point& point : points) {
      const double distance = straight_distance_m(point.position_ws, p);
      ASSERT_LE(visits[point.number], 1u) << "seed " << seed;
      ASSERT_TRUE(distance > radius || visits[point.number] == 1) << "seed " << seed;
      const bool floats_hold_squares = distance > 2e-19 && radius < 1.8e19;
      ASSERT_FALSE(floats_hold_squares && distance > 1.0001 * radius && visits[point.number] > 0) << "seed " << seed;
    }
  }
}

}  // namespace
}  // namespace chandelier::lights
