// SPDX-License-Identifier: Apache-2.0
// The new origin of a scene that is far from its own: one rule for the baker and for previews.
#pragma once

#include <cmath>
#include <glm/vec3.hpp>

namespace chandelier::pack {

/// Up to here floats are at most 0.06 mm apart.
constexpr double near_origin_m = 512.0;

/// On each axis the middle of the box in whole metres, if that is far from 0 and the box does not reach 0; coordinates
/// then become half as large at least. Otherwise 0.
inline glm::dvec3 scene_origin(const glm::dvec3& low, const glm::dvec3& high) {
  glm::dvec3 origin(0.0);
  for (int axis = 0; axis < 3; ++axis) {
    const double middle = 0.5 * (low[axis] + high[axis]), half = 0.5 * (high[axis] - low[axis]);
    if (std::abs(middle) >= near_origin_m && std::abs(middle) > half) origin[axis] = std::round(middle);
  }
  return origin;
}

}  // namespace chandelier::pack
