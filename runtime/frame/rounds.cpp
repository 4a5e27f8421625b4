// SPDX-License-Identifier: Apache-2.0
#include "frame/rounds.h"

#include "shadows/deliver/visibility_textures.h"

namespace chandelier {

std::vector<Round> plan_rounds(LightList& list, std::vector<frame::ShadowView>& views, const RoundLimits& limits) {
  std::vector<Round> rounds;
  for (uint32_t m = 0; m < list.maps.size(); ++m) {
    frame::ShadowMap& map = list.maps[m];
    const auto is_full = [&](const Round& round) {
      return round.map_count == limits.maps || uint64_t{round.view_count} + map.view_count > limits.views ||
             round.visibility_bytes + visibility_bytes(map) > limits.visibility_bytes;
    };
    if (rounds.empty() || is_full(rounds.back()))
      rounds.push_back({.first_map = m, .first_view = map.first_view, .first_light = map.first_light});
    Round& round = rounds.back();
    map.cube = round.map_count++;
    map.first_visibility = static_cast<uint32_t>(round.visibility_bytes);
    round.view_count += map.view_count;
    round.light_count += map.light_count;
    round.visibility_bytes += visibility_bytes(map);
    for (uint32_t v = map.first_view; v < map.first_view + map.view_count; ++v) views[v].layer += 6 * map.cube;
  }
  if (!list.shadowless.empty()) {
    if (rounds.empty()) rounds.emplace_back();
    rounds.back().shadowless_count = static_cast<uint32_t>(list.shadowless.size());
  }
  return rounds;
}

}  // namespace chandelier
