// SPDX-License-Identifier: Apache-2.0
#include "lights/map_candidates.h"

#include <algorithm>
#include <cstddef>
#include <utility>

#include "lights/pack_lights.h"

namespace chandelier {

MapCandidates::MapCandidates(std::span<const pack::Light> lights, DynamicLights dynamic_lights) {
  places_.reserve(lights.size());
  for (const pack::Light& light : lights) {
    const bool keeps_own =
        light.group != 0 || light.unclustered != 0 || (light.dynamic != 0 && dynamic_lights == DynamicLights::own);
    if (is_directional(light))
      places_.push_back({light.direction_ws, keeps_own ? Kind::shares_none : Kind::directional});
    else
      places_.push_back({light.position_ws, keeps_own ? Kind::shares_none : Kind::placed});
  }
}

void MapCandidates::nearest(uint32_t light, std::span<const uint32_t> centers, size_t most,
                            std::vector<uint32_t>& found) const {
  found.clear();
  const Place& from = places_[light];
  if (from.kind == Kind::shares_none) return;
  std::vector<std::pair<float, uint32_t>> others;
  for (const uint32_t center : centers)
    if (center != light && places_[center].kind == from.kind)
      others.push_back({glm::distance(from.at, places_[center].at), center});
  const size_t kept = std::min(most, others.size());
  std::partial_sort(others.begin(), others.begin() + static_cast<ptrdiff_t>(kept), others.end());
  for (size_t i = 0; i < kept; ++i) found.push_back(others[i].second);
}

}  // namespace chandelier
