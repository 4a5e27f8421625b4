// SPDX-License-Identifier: Apache-2.0
// LightCluster §3.1: minimum-distance clustering of point lights.
#include "lights/light_clusters.h"

#include <algorithm>
#include <limits>
#include <numeric>

namespace chandelier::lights {
namespace {

struct Center {
  uint32_t light;
  glm::vec3 position_ws;
  float d_min_m;
};

std::vector<uint32_t> by_descending_range(std::span<const ClusterLight> lights) {
  std::vector<uint32_t> order(lights.size());
  std::iota(order.begin(), order.end(), 0u);
  std::stable_sort(order.begin(), order.end(),
                   [&](uint32_t a, uint32_t b) { return lights[a].range_m > lights[b].range_m; });
  return order;
}

// §3.1.2
std::vector<Center> select_centers(std::span<const ClusterLight> lights, std::span<const uint32_t> order,
                                   const ClusterSettings& settings) {
  std::vector<Center> centers;
  for (uint32_t light : order) {
    const glm::vec3 position = lights[light].position_ws;
    const bool near_one = std::any_of(centers.begin(), centers.end(), [&](const Center& center) {
      return glm::distance(position, center.position_ws) <= center.d_min_m;
    });
    if (!near_one) centers.push_back({light, position, scaled_d_min(settings, position)});
  }
  return centers;
}

}  // namespace

float scaled_d_min(const ClusterSettings& settings, const glm::vec3& center_ws) {
  const float depth = glm::distance(settings.camera_ws, center_ws) / settings.z_far_m;
  switch (settings.scaling) {
    case DistanceScaling::grow:
      return settings.d_init_m * (1.0f + depth);
    case DistanceScaling::paper_formula:
      return settings.d_init_m * std::max(0.0f, 1.0f - depth);
    case DistanceScaling::none:
      break;
  }
  return settings.d_init_m;
}

LightClusters select_light_clusters(std::span<const ClusterLight> lights, const ClusterSettings& settings) {
  const auto order = by_descending_range(lights);
  const auto centers = select_centers(lights, order, settings);

  // Clusters are kept in the order of their centres' indices: with d_init 0 that is the order of the lights.
  std::vector<uint32_t> rank(centers.size());
  std::iota(rank.begin(), rank.end(), 0u);
  std::sort(rank.begin(), rank.end(), [&](uint32_t a, uint32_t b) { return centers[a].light < centers[b].light; });
  LightClusters result;
  std::vector<uint32_t> cluster_of_center(centers.size());
  for (uint32_t c : rank) {
    cluster_of_center[c] = static_cast<uint32_t>(result.clusters.size());
    result.clusters.push_back({centers[c].light, centers[c].d_min_m, lights[centers[c].light].range_m, 0});
  }

  // §3.1.3
  result.cluster_of_light.resize(lights.size());
  for (uint32_t light = 0; light < lights.size(); ++light) {
    float nearest = std::numeric_limits<float>::infinity();
    uint32_t cluster = 0;
    for (uint32_t c = 0; c < centers.size(); ++c) {
      const float distance = glm::distance(lights[light].position_ws, centers[c].position_ws);
      if (distance < nearest) {
        nearest = distance;
        cluster = cluster_of_center[c];
      }
    }
    LightCluster& joined = result.clusters[cluster];
    joined.range_m = std::max(joined.range_m, nearest + lights[light].range_m);
    ++joined.light_count;
    result.cluster_of_light[light] = cluster;
  }
  return result;
}

}  // namespace chandelier::lights
