// SPDX-License-Identifier: Apache-2.0
// Whose shadow map a light may take, and which of them are near.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "lights/light_clusters.h"
#include "pack_schema.h"

namespace chandelier {

/// Lights of one kind may share: those with a place among themselves, and directional ones. A light that keeps a map of
/// its own, or its group's, takes and gives none.
class MapCandidates {
 public:
  MapCandidates(std::span<const pack::Light> lights, DynamicLights dynamic_lights);

  /// Puts up to `most` of `centers` whose map the light may take into `found`, the nearest first; directional lights by
  /// their directions; ties to the lower number.
  void nearest(uint32_t light, std::span<const uint32_t> centers, size_t most, std::vector<uint32_t>& found) const;

 private:
  enum class Kind : uint8_t { shares_none, placed, directional };
  struct Place {
    glm::vec3 at;  // position, or direction
    Kind kind;
  };
  std::vector<Place> places_;
};

}  // namespace chandelier
