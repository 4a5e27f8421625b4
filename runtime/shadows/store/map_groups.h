// SPDX-License-Identifier: Apache-2.0
// Where there are more shadow maps than the pool holds, a frame draws and shades them in groups: memory stays within
// its budget and no light loses its shadow.
#pragma once

#include <vector>

#include "lights/light_list.h"

namespace chandelier {

/// How large each map is: what store `cube-array` says, one size for all.
void size_maps(const Recipe& recipe, LightList& list);

struct MapGroup {
  uint32_t first_map;
  uint32_t map_count;
  uint32_t cube_count;  // of the store, that they take
  uint32_t first_view;
  uint32_t view_count;
  uint32_t first_light;
  uint32_t light_count;       // of its maps
  uint32_t shadowless_count;  // lights that follow them, of no map; in the last group
  uint64_t visibility_bytes;  // of all its maps' visibility textures
};

/// What a group may hold at most. A single map may exceed all but the first.
struct GroupLimits {
  uint32_t cubes = 1;          // of the store
  uint32_t layer_size_px = 1;  // width of the store's layers; no map is larger
  uint64_t views = UINT64_MAX;
  uint64_t visibility_bytes = UINT64_MAX;
};

/// Splits the maps into groups, the last of which has the lights without shadow too, and gives every map the place of
/// its visibility texture.
std::vector<MapGroup> plan_groups(LightList& list, const GroupLimits& limits);

}  // namespace chandelier
