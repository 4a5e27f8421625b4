// SPDX-License-Identifier: Apache-2.0
// With stability, lights change their centres less as a camera moves.
#include <gtest/gtest.h>

#include <cmath>

#include "lights/light_clusters.h"
#include "ring_lights.h"

namespace chandelier::lights {
namespace {

// Two arcades of lamps on rings, as in the paper's atrium, and a row of brighter lamps between them.
std::vector<ClusterLight> hall() {
  std::vector<ClusterLight> lights = ring_lights();
  for (int i = 0; i < 24; ++i) {
    const auto at = static_cast<float>(i);
    lights.push_back({{at - 12.0f, 4.0f + 0.3f * std::sin(at), std::cos(2.0f * at)}, 8.0f + std::sin(3.0f * at)});
  }
  return lights;
}

// Round the hall at walking pace, 5 cm a frame.
glm::vec3 step(int frame) {
  const float around = 0.05f * static_cast<float>(frame) / 8.0f;
  return {11.0f * std::cos(around), 1.7f, 5.5f * std::sin(around)};
}

struct Walk {
  uint32_t changes = 0;  // of a light's centre from one frame to the next
  uint32_t maps = 0;     // of all frames
};

Walk walk(float d_init_m, float stability) {
  const std::vector<ClusterLight> lights = hall();
  ClusterSettings settings{.d_init_m = d_init_m, .stability = stability};
  std::vector<uint32_t> before;
  Walk result;
  for (int frame = 0; frame < 1000; ++frame) {
    settings.camera_ws = step(frame);
    settings.previous_centers = before;
    const LightClusters clusters = select_light_clusters(lights, settings);
    std::vector<uint32_t> centers;
    for (const uint32_t cluster : clusters.cluster_of_light) centers.push_back(clusters.clusters[cluster].center);
    for (size_t i = 0; i < before.size(); ++i) result.changes += before[i] != centers[i];
    result.maps += static_cast<uint32_t>(clusters.clusters.size());
    before = centers;
  }
  return result;
}

TEST(LightStabilityTest, FewerChangesOfCenterForNearlyAsManyMaps) {
  for (const float d_init_m : {0.3f, 0.5f, 1.6f}) {
    const Walk paper = walk(d_init_m, 0.0f), stable = walk(d_init_m, 0.3f);
    EXPECT_GT(paper.changes, 30u) << d_init_m;
    EXPECT_LT(stable.changes, paper.changes / 2) << d_init_m;
    EXPECT_NEAR(stable.maps / static_cast<double>(paper.maps), 1.0, 0.12) << d_init_m;
    RecordProperty("d_init_" + std::to_string(d_init_m),
                   std::to_string(paper.changes) + " to " + std::to_string(stable.changes) + " changes, " +
                       std::to_string(paper.maps) + " to " + std::to_string(stable.maps) + " maps");
  }
}

// A camera that stands still changes nothing: what the paper's selection chose is chosen again.
TEST(LightStabilityTest, WhatWasSelectedIsSelectedAgain) {
  const std::vector<ClusterLight> lights = hall();
  for (int frame = 0; frame < 1000; frame += 50) {
    ClusterSettings settings{.camera_ws = step(frame), .d_init_m = 0.7f};
    const LightClusters first = select_light_clusters(lights, settings);
    std::vector<uint32_t> centers;
    for (const uint32_t cluster : first.cluster_of_light) centers.push_back(first.clusters[cluster].center);
    settings.previous_centers = centers;
    settings.stability = 0.4f;
    EXPECT_EQ(select_light_clusters(lights, settings).cluster_of_light, first.cluster_of_light);
  }
}

// A light a little nearer than d_min to a brighter one: it stays a centre if it was one.
TEST(LightStabilityTest, ACenterStaysOneBeyondLessThanDMin) {
  const ClusterLight lights[]{{{0, 0, 0}, 9}, {{0.9f, 0, 0}, 8}, {{1.05f, 0, 0}, 1}};
  ClusterSettings settings{.d_init_m = 1.0f, .scaling = DistanceScaling::none, .stability = 0.3f};
  const auto centers = [&](const std::vector<uint32_t>& previous) {
    settings.previous_centers = previous;
    std::vector<uint32_t> result;
    for (const LightCluster& cluster : select_light_clusters(lights, settings).clusters)
      result.push_back(cluster.center);
    return result;
  };
  EXPECT_EQ(centers({}), (std::vector<uint32_t>{0, 2}));
  EXPECT_EQ(centers({0, 1, 1}), (std::vector<uint32_t>{0, 1}));
  EXPECT_EQ(centers({0, 0, 0}), (std::vector<uint32_t>{0}));  // others become centres beyond 1.075 m
  settings.stability = 0.0f;                                  // the paper's selection, whatever was before
  EXPECT_EQ(centers({0, 1, 1}), (std::vector<uint32_t>{0, 2}));
}

}  // namespace
}  // namespace chandelier::lights
