// SPDX-License-Identifier: Apache-2.0
// Light clusters: groups of lights that share one shadow map (LightCluster §3.1). Plain C++, no Vulkan.
#pragma once

#include <cstdint>
#include <functional>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "lights/cluster_metric.h"
#include "recipe_schema.h"

namespace chandelier::lights {

/// Of `previous_centers`: the light had none.
constexpr uint32_t no_center = 0xFFFFFFFF;

struct ClusterSettings {
  glm::vec3 camera_ws{0.0f};
  float d_init_m = 0.5f;
  float z_far_m = 30.0f;
  DistanceScaling scaling = DistanceScaling::grow;  // README.md of this folder says why there are three
  DynamicLights dynamic_lights = DynamicLights::cluster;
  float stability = 0.0f;                      // 0 to below 1: how strongly the frame before is preferred; 0 not at all
  std::span<const uint32_t> previous_centers;  // of each light its centre a frame ago, or no_center; or nothing at all
};

/// Whether a light cannot take a centre's shadow map, wherever the two stand: indices into the lights. May be empty.
using Blocked = std::function<bool(uint32_t light, uint32_t center)>;

struct LightCluster {
  uint32_t center;       // index of the light whose position the shadow map is drawn from
  float d_min_m;         // radius of the area light that stands for the cluster
  float range_m;         // C_att = max over members of d_C + range: beyond it no member reaches
  float spread_m;        // largest metric distance of a member; 0 where all stand in one place
  uint32_t light_count;  // members, the centre included
};

struct LightClusters {
  std::vector<LightCluster> clusters;      // in ascending order of centre
  std::vector<uint32_t> cluster_of_light;  // one per light
};

float scaled_d_min(const ClusterSettings& settings, const glm::vec3& center_ws);

/// Does it keep a shadow map of its own, which no other light takes? Not where it is in a group.
bool has_own_center(const ClusterLight& light, const ClusterSettings& settings);

/// Selects centres in descending order of priority, then of range, ties by index: a light becomes a centre when it is
/// farther than d_min from every centre so far that is not blocked (§3.1.2). Then every other light joins its nearest
/// centre, ties to the one selected first (§3.1.3). Lights of a group are a cluster by themselves, whatever lies
/// between, and the first of them in the same order is its centre. Finite input; O(lights log lights) where clusters
/// are about as large as d_min says. With stability s > 0, lights that were centres come first and stay centres beyond
/// (1 - s) d_min, the others become centres beyond (1 + s / 4) d_min, and a light keeps its centre while that is one
/// and within as much.
LightClusters select_light_clusters(std::span<const ClusterLight> lights, const ClusterSettings& settings,
                                    const Blocked& blocked = {});

}  // namespace chandelier::lights
