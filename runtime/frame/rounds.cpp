// SPDX-License-Identifier: Apache-2.0
#include "frame/rounds.h"

namespace chandelier {

std::vector<Round> plan_rounds(LightList& list, std::vector<frame::ShadowView>& views, uint32_t cubes,
                               uint64_t max_views) {
  std::vector<Round> rounds;
  for (uint32_t m = 0; m < list.maps.size(); ++m) {
    frame::ShadowMap& map = list.maps[m];
    const bool full = !rounds.empty() && (rounds.back().map_count == cubes ||
                                          uint64_t{rounds.back().view_count} + map.view_count > max_views);
    if (rounds.empty() || full) rounds.push_back({m, 0, map.first_view, 0});
    Round& round = rounds.back();
    map.cube = round.map_count++;
    round.view_count += map.view_count;
    for (uint32_t v = map.first_view; v < map.first_view + map.view_count; ++v) views[v].layer += 6 * map.cube;
  }
  return rounds;
}

}  // namespace chandelier
