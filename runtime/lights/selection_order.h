// SPDX-License-Identifier: Apache-2.0
// LightCluster §3.1.2: in which order lights are asked whether they become centres.
#pragma once

#include <algorithm>
#include <bit>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "lights/cluster_metric.h"

namespace chandelier::lights {

/// Of the lights that `which` names by index: those of which `goes_first` is true, the others; within both by
/// descending priority, then range, ties by index.
template <typename Which, typename GoesFirst>
std::vector<uint32_t> selection_order(std::span<const ClusterLight> lights, Which which, GoesFirst goes_first) {
  std::vector<std::pair<uint64_t, uint32_t>> keys;
  keys.reserve(lights.size());
  for (uint32_t light = 0; light < lights.size(); ++light) {
    if (!which(light)) continue;
    const ClusterLight& each = lights[light];
    // The bits of floats that are not negative rise with their values.
    const uint32_t falling = 0x7FFFFFFFu - std::bit_cast<uint32_t>(each.range_m + 0.0f);
    keys.push_back({uint64_t{!goes_first(light)} << 40 | uint64_t{255 - each.priority} << 32 | falling, light});
  }
  std::sort(keys.begin(), keys.end());
  std::vector<uint32_t> order;
  order.reserve(keys.size());
  for (const auto& [key, light] : keys) order.push_back(light);
  return order;
}

}  // namespace chandelier::lights
