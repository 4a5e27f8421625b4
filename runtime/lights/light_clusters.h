// SPDX-License-Identifier: Apache-2.0
// Light clusters: groups of lights that share one shadow map (LightCluster §3.1). Plain C++, no Vulkan.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

namespace chandelier::lights {

/// What clustering knows of a light. World space, metres.
struct ClusterLight {
  glm::vec3 position_ws;
  float range_m;
};

/// d_min of a centre at distance |C| from the camera (README.md of this folder says why there are three).
enum class DistanceScaling : uint32_t {
  grow,           // d_init * (1 + |C| / z_far): the paper's text, Figure 3 and Table 1
  paper_formula,  // d_init * max(0, 1 - |C| / z_far): the paper's equation as printed
  none,           // d_init: stable under a moving camera
};

struct ClusterSettings {
  glm::vec3 camera_ws{0.0f};
  float d_init_m = 0.5f;
  float z_far_m = 30.0f;
  DistanceScaling scaling = DistanceScaling::grow;
};

struct LightCluster {
  uint32_t center;       // index of the light whose position the shadow map is drawn from
  float d_min_m;         // radius of the area light that stands for the cluster
  float range_m;         // C_att = max over members of d_C + range: beyond it no member reaches
  uint32_t light_count;  // members, the centre included
};

struct LightClusters {
  std::vector<LightCluster> clusters;      // in ascending order of centre
  std::vector<uint32_t> cluster_of_light;  // one per light
};

float scaled_d_min(const ClusterSettings& settings, const glm::vec3& center_ws);

/// Selects centres in descending order of range, ties by index: a light becomes a centre when it is farther than d_min
/// from every centre so far (§3.1.2). Then every other light joins its nearest centre, ties to the one selected first
/// (§3.1.3). Needs finite positions and ranges; O(lights * clusters).
LightClusters select_light_clusters(std::span<const ClusterLight> lights, const ClusterSettings& settings);

}  // namespace chandelier::lights
