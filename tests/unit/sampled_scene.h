// SPDX-License-Identifier: Apache-2.0
// Small scenes, and samples of what a camera above them sees.
#pragma once

#include <cstdint>
#include <map>
#include <numeric>
#include <optional>
#include <random>
#include <vector>

#include "../gpu/scene_builder.h"
#include "lights/error_estimate.h"
#include "lights/light_samples.h"

namespace chandelier::test {

inline constexpr ShadowReading hard{Filter::hard, 512};

// Straight down on a floor 8 m wide.
inline Camera from_above() {
  Camera camera;
  camera.eye_ws = {0, 6, 0};
  camera.forward_ws = {0, -1, 0};
  camera.up_ws = {0, 0, -1};
  camera.yfov_rad = 1.1f;
  return camera;
}

// A wall along z divides the floor; lights stand at x = -2, -1, 1 and 2 m.
inline test::Scene divided_floor() {
  test::Scene scene;
  const uint32_t white = scene.add_material(test::plain_material(glm::vec3(0.8f)));
  scene.add(test::level_square(glm::vec3(0), 4), white);
  scene.add(test::box({-0.01f, 0.0f, -4.0f}, {0.01f, 4.0f, 4.0f}), white);
  for (const float x : {-2.0f, -1.0f, 1.0f, 2.0f}) scene.lights.push_back(test::point_light({x, 1.5f, 0.0f}, 10, 20));
  return scene;
}

// Pillars under a grid of lights of several colours and ranges.
inline test::Scene pillars(uint32_t seed) {
  std::mt19937 random(seed);
  const auto uniform = [&](float from, float to) {
    return from + (to - from) * static_cast<float>(random() >> 8) * 0x1p-24f;
  };
  test::Scene scene;
  const uint32_t white = scene.add_material(test::plain_material(glm::vec3(0.7f)));
  scene.add(test::level_square(glm::vec3(0), 4), white);
  for (int i = 0; i < 9; ++i) {
    const glm::vec3 at(uniform(-3, 3), 0.0f, uniform(-3, 3));
    scene.add(test::box(at, at + glm::vec3(0.3f, uniform(0.5f, 2.0f), 0.3f)), white);
  }
  for (int i = 0; i < 24; ++i) {
    const float x = uniform(-3, 3), z = uniform(-3, 3);
    scene.lights.push_back(test::point_light({x, uniform(1.0f, 3.0f), z}, uniform(1, 20), uniform(2, 8)));
  }
  return scene;
}

struct Sampled {
  explicit Sampled(const test::Scene& scene, const SampleSettings& settings = {})
      : pack(scene.open()), world(pack), rays(pack.view()), sampled(pack.view(), rays) {
    std::vector<LightId> shadowed;
    for (LightId id = 0; id < world.lights().size(); ++id)
      if (world.lights()[id].shadowless == 0) shadowed.push_back(id);
    samples.emplace(sampled, sampled_lights(world, shadowed), from_above(), 16.0f / 9.0f, settings);
  }
  double rmse(const std::vector<MapMember>& members) const { return estimated_rmse(*samples, members, hard); }

  pack::File pack;
  World world;
  rays::PackRays rays;
  SampledScene sampled;
  std::optional<LightSamples> samples;
};

// What each light takes of all maps together.
inline std::map<uint32_t, float> shares_of(const std::vector<MapMember>& members) {
  std::map<uint32_t, float> sums;
  for (const MapMember& m : members) sums[m.light] += m.share;
  return sums;
}

}  // namespace chandelier::test
