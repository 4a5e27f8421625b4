// SPDX-License-Identifier: Apache-2.0
#include "shadows/store/map_groups.h"

#include "shadows/deliver/visibility_textures.h"
#include "shadows/store/cube_places.h"

namespace chandelier {

void size_maps(const Recipe& recipe, LightList& list) {
  switch (recipe.store) {
    case Store::cube_array:
      for (frame::ShadowMap& map : list.maps) map.size_px = recipe.face_size_px;
      return;
  }
  refuse_answer(recipe.store);
}

std::vector<MapGroup> plan_groups(LightList& list, const GroupLimits& limits) {
  std::vector<MapGroup> groups;
  CubePlaces places(limits.layer_size_px, limits.cubes);
  for (uint32_t m = 0; m < list.maps.size(); ++m) {
    frame::ShadowMap& map = list.maps[m];
    const auto is_full = [&](const MapGroup& group) {
      return uint64_t{group.view_count} + map.view_count > limits.views ||
             group.visibility_bytes + visibility_bytes(map) > limits.visibility_bytes || !places.take(map.size_px);
    };
    if (groups.empty() || is_full(groups.back())) {
      groups.push_back({.first_map = m, .first_view = map.first_view, .first_light = map.first_light});
      places = CubePlaces(limits.layer_size_px, limits.cubes);
      places.take(map.size_px);
    }
    MapGroup& group = groups.back();
    map.first_visibility = static_cast<uint32_t>(group.visibility_bytes);
    ++group.map_count;
    group.cube_count = places.used_cubes();
    group.view_count += map.view_count;
    group.light_count += map.light_count;
    group.visibility_bytes += visibility_bytes(map);
  }
  if (!list.shadowless.empty()) {
    if (groups.empty()) groups.emplace_back();
    groups.back().shadowless_count = static_cast<uint32_t>(list.shadowless.size());
  }
  return groups;
}

}  // namespace chandelier
