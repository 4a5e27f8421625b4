// SPDX-License-Identifier: Apache-2.0
#include "shadows/store/map_groups.h"

#include "shadows/deliver/visibility_textures.h"

namespace chandelier {

std::vector<MapGroup> plan_groups(LightList& list, std::vector<frame::ShadowView>& views, const GroupLimits& limits) {
  std::vector<MapGroup> groups;
  for (uint32_t m = 0; m < list.maps.size(); ++m) {
    frame::ShadowMap& map = list.maps[m];
    const auto is_full = [&](const MapGroup& group) {
      return group.map_count == limits.maps || uint64_t{group.view_count} + map.view_count > limits.views ||
             group.visibility_bytes + visibility_bytes(map) > limits.visibility_bytes;
    };
    if (groups.empty() || is_full(groups.back()))
      groups.push_back({.first_map = m, .first_view = map.first_view, .first_light = map.first_light});
    MapGroup& group = groups.back();
    map.cube = group.map_count++;
    map.first_visibility = static_cast<uint32_t>(group.visibility_bytes);
    group.view_count += map.view_count;
    group.light_count += map.light_count;
    group.visibility_bytes += visibility_bytes(map);
    for (uint32_t v = map.first_view; v < map.first_view + map.view_count; ++v) views[v].layer += 6 * map.cube;
  }
  if (!list.shadowless.empty()) {
    if (groups.empty()) groups.emplace_back();
    groups.back().shadowless_count = static_cast<uint32_t>(list.shadowless.size());
  }
  return groups;
}

}  // namespace chandelier
