// SPDX-License-Identifier: Apache-2.0
// Where there are more shadow maps than the pool holds, a frame draws and shades them in rounds: memory stays within
// its budget and no light loses its shadow.
#pragma once

#include <vector>

#include "lights/light_list.h"

namespace chandelier {

struct Round {
  uint32_t first_map;
  uint32_t map_count;
  uint32_t first_view;
  uint32_t view_count;
};

/// Splits the maps into rounds of at most `cubes` maps and `max_views` views (a single map may exceed the latter), and
/// gives every map its cube and every view its layer.
std::vector<Round> plan_rounds(LightList& list, std::vector<frame::ShadowView>& views, uint32_t cubes,
                               uint64_t max_views);

}  // namespace chandelier
