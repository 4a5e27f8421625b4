// SPDX-License-Identifier: Apache-2.0
// From where on a light's shadow map sees what throws shadows.
#pragma once

#include <algorithm>

#include "pack_schema.h"

namespace chandelier::pack {

/// Where nothing is nearer: near enough for what will move there, and depths of triangles that pass the light stay
/// exact.
constexpr float most_shadow_near_m = 0.01f;
/// What is nearer than this to a light may cast no shadow.
constexpr float least_shadow_near_m = 1e-4f;
/// On the face of a cube, what is a metre away is at least 1/√3 m away along the face's axis. A little less, for
/// rounding.
constexpr float shadow_near_per_distance = 0.57f;

/// The near plane of a shadow map that is drawn from a point or spot light, metres.
inline float shadow_near_m(const Light& light) {
  return std::clamp(shadow_near_per_distance * light.nearest_caster_m, least_shadow_near_m, most_shadow_near_m);
}

}  // namespace chandelier::pack
