// SPDX-License-Identifier: Apache-2.0
// Selection of light clusters: the paper's counts, and what must hold of any lights.
#include "lights/light_clusters.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>

#include "ring_lights.h"

namespace chandelier::lights {
namespace {

TEST(LightClustersTest, PaperTable1) {
  const std::pair<float, size_t> rows[]{{0.0f, 80}, {0.1f, 80}, {0.3f, 44}, {0.5f, 26}, {1.6f, 10}};
  for (const auto& [d_init_m, count] : rows) {
    const auto result = select_light_clusters(
        ring_lights(),
        {.camera_ws = {-11, 2, 2}, .d_init_m = d_init_m, .z_far_m = 30.0f, .scaling = DistanceScaling::grow});
    EXPECT_EQ(result.clusters.size(), count) << "d_init " << d_init_m;
  }
}

TEST(LightClustersTest, ThreeScalingsOfDMin) {
  ClusterSettings settings{.camera_ws = {1, 0, 0}, .d_init_m = 0.5f, .z_far_m = 20.0f};
  const glm::vec3 ten_metres_off(1, 10, 0), thirty(1, 0, 30);
  settings.scaling = DistanceScaling::grow;
  EXPECT_FLOAT_EQ(scaled_d_min(settings, ten_metres_off), 0.75f);
  EXPECT_FLOAT_EQ(scaled_d_min(settings, thirty), 1.25f);
  settings.scaling = DistanceScaling::paper_formula;
  EXPECT_FLOAT_EQ(scaled_d_min(settings, ten_metres_off), 0.25f);
  EXPECT_FLOAT_EQ(scaled_d_min(settings, thirty), 0.0f);
  settings.scaling = DistanceScaling::none;
  EXPECT_FLOAT_EQ(scaled_d_min(settings, ten_metres_off), 0.5f);
  EXPECT_FLOAT_EQ(scaled_d_min(settings, thirty), 0.5f);
}

TEST(LightClustersTest, NoLightsAndOneLight) {
  EXPECT_TRUE(select_light_clusters({}, {}).clusters.empty());
  const ClusterLight one{{1, 2, 3}, 4};
  const auto result = select_light_clusters({&one, 1}, {.d_init_m = 2.0f, .scaling = DistanceScaling::none});
  ASSERT_EQ(result.clusters.size(), 1u);
  EXPECT_EQ(result.clusters[0].center, 0u);
  EXPECT_EQ(result.clusters[0].range_m, 4.0f);
  EXPECT_EQ(result.clusters[0].d_min_m, 2.0f);
  EXPECT_EQ(result.clusters[0].light_count, 1u);
}

// The largest range becomes a centre first; a light exactly d_min away is not farther than d_min.
TEST(LightClustersTest, LargestRangeFirstAndDMinIsInclusive) {
  const ClusterLight lights[]{{{0, 0, 0}, 1}, {{1, 0, 0}, 5}, {{2, 0, 0}, 1}, {{2.001f, 0, 0}, 0.5f}};
  const auto result = select_light_clusters(lights, {.d_init_m = 1.0f, .scaling = DistanceScaling::none});
  ASSERT_EQ(result.clusters.size(), 2u);
  EXPECT_EQ(result.clusters[0].center, 1u);
  EXPECT_EQ(result.clusters[1].center, 3u);
  EXPECT_EQ(result.cluster_of_light, (std::vector<uint32_t>{0, 0, 1, 1}));  // the third is nearer to the fourth
  EXPECT_FLOAT_EQ(result.clusters[0].range_m, 5.0f);
  EXPECT_FLOAT_EQ(result.clusters[1].range_m, 0.001f + 1.0f);
}

// Equal ranges: the first light is the centre. Equally near centres: the one selected first.
TEST(LightClustersTest, TiesGoByIndex) {
  const ClusterLight lights[]{{{0, 0, 0}, 2}, {{2, 0, 0}, 2}, {{1, 0, 0}, 2}};
  const auto result = select_light_clusters(lights, {.d_init_m = 1.5f, .scaling = DistanceScaling::none});
  ASSERT_EQ(result.clusters.size(), 2u);
  EXPECT_EQ(result.clusters[0].center, 0u);
  EXPECT_EQ(result.clusters[1].center, 1u);
  EXPECT_EQ(result.cluster_of_light[2], 0u);
}

// The most that a light's apparent place moves for a receiver within its cone, by trying many receivers.
double most_apparent_offset(const ClusterLight& light, const glm::vec3& center_ws) {
  const glm::dvec3 offset = glm::dvec3(center_ws) - glm::dvec3(light.position_ws);
  const glm::dvec3 axis(light.axis_ws);
  const glm::dvec3 u =
      glm::normalize(glm::cross(axis, std::abs(axis.x) < 0.9 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0)));
  const glm::dvec3 v = glm::cross(axis, u);
  const double cone_rad = std::acos(double{light.cone_cos});
  double most = 0.0;
  for (int i = 0; i <= 60; ++i) {
    for (int k = 0; k < 120; ++k) {
      const double off_axis = cone_rad * i / 60.0, around = 2.0 * 3.14159265358979 * k / 120.0;
      const glm::dvec3 way =
          std::cos(off_axis) * axis + std::sin(off_axis) * (std::cos(around) * u + std::sin(around) * v);
      most = std::max(most, glm::length(glm::cross(offset, way)));
    }
  }
  return most;
}

TEST(ClusterMetricTest, ASpotLightsDistanceIsItsLargestApparentOffsetButAtLeastHalf) {
  std::mt19937 random(9);
  const auto uniform = [&](float from, float to) {
    return from + (to - from) * static_cast<float>(random() >> 8) * 0x1p-24f;
  };
  uint32_t half = 0, whole = 0;
  for (int i = 0; i < 300; ++i) {
    ClusterLight light{{uniform(-3, 3), uniform(-3, 3), uniform(-3, 3)}, 5.0f};
    light.axis_ws = glm::normalize(glm::vec3(uniform(-1, 1), uniform(-1, 1), uniform(-1, 1)) + glm::vec3(0, 0, 1e-3f));
    light.cone_cos = std::cos(uniform(0.02f, i % 2 == 0 ? 0.3f : 1.5f));
    const glm::vec3 center(uniform(-3, 3), uniform(-3, 3), uniform(-3, 3));
    const double straight = straight_distance_m(light.position_ws, center);
    const double expected = std::max(0.5 * straight, most_apparent_offset(light, center));
    const double distance = metric_distance_m(light, center);
    EXPECT_NEAR(distance, expected, 0.002 * straight);
    EXPECT_LE(distance, straight);
    EXPECT_GE(distance * straight_per_metric(light), straight);
    half += distance == 0.5 * straight;
    whole += distance == straight;
    light.cone_cos = -1.0f;
    EXPECT_EQ(metric_distance_m(light, center), straight);
  }
  EXPECT_GT(half, 5u);
  EXPECT_GT(whole, 50u);
}

// Two lamps that shine down, one above the other: from below they are in one place.
TEST(ClusterMetricTest, SpotLightsThatShineAlongTheirLineAreNear) {
  ClusterLight lights[]{{{0, 3, 0}, 5}, {{0, 4.5f, 0}, 4}, {{1.5f, 3, 0}, 3}};
  for (ClusterLight& light : lights) light.cone_cos = 0.95f;
  const ClusterSettings settings{.d_init_m = 1.0f, .scaling = DistanceScaling::none};
  const auto result = select_light_clusters(lights, settings);
  EXPECT_EQ(result.cluster_of_light, (std::vector<uint32_t>{0, 0, 1}));
  EXPECT_FLOAT_EQ(result.clusters[0].range_m, 1.5f + 4.0f);  // C_att is by straight distance
  EXPECT_FLOAT_EQ(result.clusters[0].spread_m, 0.75f);
  for (ClusterLight& light : lights) light.cone_cos = -1.0f;
  EXPECT_EQ(select_light_clusters(lights, settings).clusters.size(), 3u);
}

TEST(LightClustersTest, ALightWithACenterOfItsOwnJoinsNoneAndNoneJoinsIt) {
  ClusterLight lights[]{{{0, 0, 0}, 9}, {{0.1f, 0, 0}, 1}, {{0.2f, 0, 0}, 2}, {{0.2f, 0, 0}, 8}};
  ClusterSettings settings{.d_init_m = 1.0f, .scaling = DistanceScaling::none};
  lights[0].dynamic = true;
  EXPECT_EQ(select_light_clusters(lights, settings).clusters.size(), 1u);
  settings.dynamic_lights = DynamicLights::own;
  EXPECT_EQ(select_light_clusters(lights, settings).cluster_of_light, (std::vector<uint32_t>{0, 1, 1, 1}));
  lights[3].unclustered = true;
  const auto result = select_light_clusters(lights, settings);
  EXPECT_EQ(result.cluster_of_light, (std::vector<uint32_t>{0, 1, 1, 2}));
  EXPECT_EQ(result.clusters[1].center, 2u);
  EXPECT_EQ(result.clusters[2].light_count, 1u);
  EXPECT_EQ(result.clusters[2].range_m, 8.0f);
}

// However far apart, whatever else they are and whatever lies between; and nobody joins them, however near.
TEST(LightClustersTest, LightsOfAGroupShareOneMapAmongThemselves) {
  ClusterLight lights[]{{{0, 0, 0}, 2}, {{0.1f, 0, 0}, 3}, {{50, 0, 0}, 5}, {{50.1f, 0, 0}, 9}, {{99, 0, 0}, 4}};
  lights[1].group = lights[2].group = lights[4].group = 7;
  lights[2].unclustered = lights[4].dynamic = true;
  const ClusterSettings settings{
      .d_init_m = 1.0f, .scaling = DistanceScaling::none, .dynamic_lights = DynamicLights::own};
  const auto result = select_light_clusters(lights, settings, [](uint32_t, uint32_t) { return true; });
  EXPECT_EQ(result.cluster_of_light, (std::vector<uint32_t>{0, 1, 1, 2, 1}));
  EXPECT_EQ(result.clusters[1].center, 2u);  // the farthest reaching of the group
  EXPECT_EQ(result.clusters[1].light_count, 3u);
  EXPECT_FLOAT_EQ(result.clusters[1].range_m, 49.0f + 4.0f);
  EXPECT_FLOAT_EQ(result.clusters[1].spread_m, 49.9f);
  lights[4].priority = 200;
  EXPECT_EQ(select_light_clusters(lights, settings).clusters[2].center, 4u);
}

TEST(LightClustersTest, LightsOfHigherPriorityAreSelectedFirst) {
  ClusterLight lights[]{{{0, 0, 0}, 9}, {{0.4f, 0, 0}, 1}, {{0.8f, 0, 0}, 2}};
  const ClusterSettings settings{.d_init_m = 0.5f, .scaling = DistanceScaling::none};
  EXPECT_EQ(select_light_clusters(lights, settings).clusters.size(), 2u);
  lights[1].priority = 129;
  const auto result = select_light_clusters(lights, settings);
  EXPECT_EQ(result.clusters.size(), 1u);
  EXPECT_EQ(result.clusters[0].center, 1u);
  EXPECT_FLOAT_EQ(result.clusters[0].range_m, 9.4f);
}

// A wall between 0 and the others: whoever is near 0 alone becomes a centre, and joins no blocked one.
TEST(LightClustersTest, BlockedPairsAreInfinitelyFarApart) {
  const ClusterLight lights[]{{{0, 0, 0}, 9}, {{0.2f, 0, 0}, 8}, {{0.4f, 0, 0}, 7}, {{-0.3f, 0, 0}, 1}};
  const ClusterSettings settings{.d_init_m = 1.0f, .scaling = DistanceScaling::none};
  const Blocked wall = [&](uint32_t light, uint32_t center) {
    return (lights[light].position_ws.x > 0.1f) != (lights[center].position_ws.x > 0.1f);
  };
  const auto result = select_light_clusters(lights, settings, wall);
  EXPECT_EQ(result.cluster_of_light, (std::vector<uint32_t>{0, 1, 1, 0}));
  EXPECT_EQ(select_light_clusters(lights, settings).clusters.size(), 1u);
}

TEST(LightClustersTest, SpreadIsTheFarthestMembersDistance) {
  const ClusterLight lights[]{{{0, 0, 0}, 9}, {{0.25f, 0, 0}, 1}, {{0, 0.5f, 0}, 1}, {{5, 0, 0}, 1}};
  const auto result = select_light_clusters(lights, {.d_init_m = 1.0f, .scaling = DistanceScaling::none});
  ASSERT_EQ(result.clusters.size(), 2u);
  EXPECT_EQ(result.clusters[0].spread_m, 0.5f);
  EXPECT_EQ(result.clusters[1].spread_m, 0.0f);
}

struct RandomSet {
  std::vector<ClusterLight> lights;
  ClusterSettings settings;
};

RandomSet random_set(uint32_t seed) {
  std::mt19937 random(seed);
  const auto uniform = [&](float from, float to) {
    return from + (to - from) * static_cast<float>(random() >> 8) * 0x1p-24f;
  };
  RandomSet set;
  const uint32_t count = 1 + static_cast<uint32_t>(random() % 120);
  for (uint32_t i = 0; i < count; ++i) {
    set.lights.push_back({{uniform(-10, 10), uniform(0, 4), uniform(-10, 10)}, uniform(0.5f, 8)});
    if (i > 0 && random() % 4 == 0) set.lights[i].position_ws = set.lights[i - 1].position_ws;  // in one place
    if (i > 0 && random() % 3 == 0) set.lights[i].range_m = set.lights[0].range_m;
  }
  set.settings = {.camera_ws = {uniform(-12, 12), uniform(0, 3), uniform(-12, 12)},
                  .d_init_m = random() % 8 == 0 ? 0.0f : uniform(0, 4),
                  .z_far_m = uniform(5, 40),
                  .scaling = static_cast<DistanceScaling>(seed % 3)};
  return set;
}

// The order in which lights are looked at: descending range, ties by index.
std::vector<uint32_t> selection_order(const std::vector<ClusterLight>& lights) {
  std::vector<uint32_t> order(lights.size());
  std::iota(order.begin(), order.end(), 0u);
  std::sort(order.begin(), order.end(), [&](uint32_t a, uint32_t b) {
    return lights[a].range_m != lights[b].range_m ? lights[a].range_m > lights[b].range_m : a < b;
  });
  return order;
}

class LightClustersOfRandomLights : public testing::TestWithParam<uint32_t> {
 protected:
  const RandomSet set = random_set(GetParam());
  const std::vector<ClusterLight>& lights = set.lights;
  const LightClusters result = select_light_clusters(set.lights, set.settings);
  double distance(uint32_t light, uint32_t center) const {
    return metric_distance_m(lights[light], lights[center].position_ws);
  }
};
INSTANTIATE_TEST_SUITE_P(Seeds, LightClustersOfRandomLights, testing::Range(0u, 20u));

TEST_P(LightClustersOfRandomLights, EveryLightIsInOneClusterAndCountsAddUp) {
  ASSERT_EQ(result.cluster_of_light.size(), lights.size());
  std::vector<uint32_t> members(result.clusters.size());
  for (const uint32_t cluster : result.cluster_of_light) {
    ASSERT_LT(cluster, result.clusters.size());
    ++members[cluster];
  }
  for (size_t c = 0; c < members.size(); ++c) {
    EXPECT_EQ(result.clusters[c].light_count, members[c]);
    EXPECT_EQ(result.cluster_of_light[result.clusters[c].center], c);
    EXPECT_TRUE(c == 0 || result.clusters[c].center > result.clusters[c - 1].center);
  }
}

// §3.1.2, as it is defined: a light is a centre exactly when it is farther than d_min from every earlier centre.
TEST_P(LightClustersOfRandomLights, CentersAreThoseFartherThanDMinFromEarlierOnes) {
  std::vector<uint32_t> earlier;
  for (const uint32_t light : selection_order(lights)) {
    const bool far_from_all = std::all_of(earlier.begin(), earlier.end(), [&](uint32_t center) {
      return distance(light, center) > scaled_d_min(set.settings, lights[center].position_ws);
    });
    const bool is_center = std::any_of(result.clusters.begin(), result.clusters.end(),
                                       [&](const LightCluster& cluster) { return cluster.center == light; });
    EXPECT_EQ(is_center, far_from_all) << "light " << light;
    if (is_center) earlier.push_back(light);
  }
}

TEST_P(LightClustersOfRandomLights, EveryLightIsWithItsNearestCenter) {
  for (uint32_t light = 0; light < lights.size(); ++light) {
    const uint32_t joined = result.clusters[result.cluster_of_light[light]].center;
    for (const LightCluster& other : result.clusters) EXPECT_LE(distance(light, joined), distance(light, other.center));
  }
}

TEST_P(LightClustersOfRandomLights, RangesCoverTheirMembersAndNoMore) {
  std::vector<double> needed(result.clusters.size(), 0.0);
  for (uint32_t light = 0; light < lights.size(); ++light) {
    const uint32_t cluster = result.cluster_of_light[light];
    needed[cluster] =
        std::max(needed[cluster], distance(light, result.clusters[cluster].center) + lights[light].range_m);
  }
  for (size_t c = 0; c < needed.size(); ++c) {
    EXPECT_FLOAT_EQ(result.clusters[c].range_m, static_cast<float>(needed[c]));
    EXPECT_EQ(result.clusters[c].d_min_m, scaled_d_min(set.settings, lights[result.clusters[c].center].position_ws));
  }
}

TEST_P(LightClustersOfRandomLights, SameInputSameOutput) {
  const LightClusters again = select_light_clusters(lights, set.settings);
  EXPECT_EQ(again.cluster_of_light, result.cluster_of_light);
  ASSERT_EQ(again.clusters.size(), result.clusters.size());
  for (size_t c = 0; c < again.clusters.size(); ++c) EXPECT_EQ(again.clusters[c].range_m, result.clusters[c].range_m);
}

}  // namespace
}  // namespace chandelier::lights
