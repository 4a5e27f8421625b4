// SPDX-License-Identifier: Apache-2.0
// LightCluster §3.1 as it is defined: every light against every centre. What the selection must equal, bit for bit.
#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>

#include "lights/light_clusters.h"

namespace chandelier::lights {

struct BruteForceSelection {
  std::span<const ClusterLight> lights;
  const ClusterSettings& settings;
  Blocked blocked;
  std::vector<uint32_t> centers = {};  // in the order of selection
  std::vector<double> d_min_m = {};    // of each

  bool clings() const { return settings.stability > 0.0f && !settings.previous_centers.empty(); }
  bool was_center(uint32_t light) const { return clings() && settings.previous_centers[light] == light; }
  bool apart(uint32_t light, uint32_t center) const { return blocked && blocked(light, center); }
  double distance(uint32_t light, uint32_t center) const {
    return metric_distance_m(lights[light], lights[center].position_ws);
  }

  bool goes_before(uint32_t a, uint32_t b) const {
    if (was_center(a) != was_center(b)) return was_center(a);
    if (lights[a].priority != lights[b].priority) return lights[a].priority > lights[b].priority;
    return lights[a].range_m > lights[b].range_m;
  }
  std::vector<uint32_t> order() const {
    std::vector<uint32_t> order;
    for (uint32_t light = 0; light < lights.size(); ++light)
      if (lights[light].group == 0 && !has_own_center(lights[light], settings)) order.push_back(light);
    std::stable_sort(order.begin(), order.end(), [&](uint32_t a, uint32_t b) { return goes_before(a, b); });
    return order;
  }

  bool covers(size_t c, uint32_t light) const {
    const double stability = clings() ? double{settings.stability} : 0.0;
    const double factor = was_center(light) ? 1.0 - stability : 1.0 + 0.25 * stability;
    return distance(light, centers[c]) <= factor * d_min_m[c] && !apart(light, centers[c]);
  }
  bool near_a_center(uint32_t light) const {
    for (size_t c = 0; c < centers.size(); ++c)
      if (covers(c, light)) return true;
    return false;
  }

  uint32_t center_of_group(uint32_t group) const {
    uint32_t first = no_center;
    for (uint32_t light = 0; light < lights.size(); ++light)
      if (lights[light].group == group && (first == no_center || goes_before(light, first))) first = light;
    return first;
  }

  uint32_t center_of(uint32_t light) const {
    if (lights[light].group != 0) return center_of_group(lights[light].group);
    if (has_own_center(lights[light], settings)) return light;
    uint32_t nearest = no_center;
    double least = 0.0;
    for (const uint32_t center : centers) {
      if (center == light) return light;
      const double m = distance(light, center);
      if ((nearest != no_center && m >= least) || apart(light, center)) continue;
      nearest = center;
      least = m;
    }
    if (!clings()) return nearest;
    for (size_t c = 0; c < centers.size(); ++c)
      if (centers[c] == settings.previous_centers[light] && covers(c, light)) return centers[c];
    return nearest;
  }

  LightClusters clusters() {
    for (const uint32_t light : order()) {
      if (near_a_center(light)) continue;
      centers.push_back(light);
      d_min_m.push_back(scaled_d_min(settings, lights[light].position_ws));
    }
    std::vector<uint32_t> center;
    for (uint32_t light = 0; light < lights.size(); ++light) center.push_back(center_of(light));
    LightClusters result;
    std::vector<uint32_t> number(lights.size());
    for (uint32_t light = 0; light < lights.size(); ++light) {
      if (center[light] != light) continue;
      number[light] = static_cast<uint32_t>(result.clusters.size());
      result.clusters.push_back({light, scaled_d_min(settings, lights[light].position_ws), 0.0f, 0.0f, 0});
    }
    for (uint32_t light = 0; light < lights.size(); ++light) {
      LightCluster& joined = result.clusters[number[center[light]]];
      const double straight = straight_distance_m(lights[light].position_ws, lights[center[light]].position_ws);
      const double range =
          std::min(straight + double{lights[light].range_m}, double{std::numeric_limits<float>::max()});
      const double spread = std::min(distance(light, center[light]), double{std::numeric_limits<float>::max()});
      joined.range_m = std::max(joined.range_m, static_cast<float>(range));
      joined.spread_m = std::max(joined.spread_m, static_cast<float>(spread));
      ++joined.light_count;
      result.cluster_of_light.push_back(number[center[light]]);
    }
    return result;
  }
};

inline LightClusters brute_force_clusters(std::span<const ClusterLight> lights, const ClusterSettings& settings,
                                          Blocked blocked = {}) {
  return BruteForceSelection{lights, settings, std::move(blocked)}.clusters();
}

}  // namespace chandelier::lights
