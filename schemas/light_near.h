// SPDX-License-Identifier: Apache-2.0
// The near plane of a light's shadow map.
#pragma once

#include <algorithm>

#include "pack_schema.h"

namespace chandelier::pack {

/// The near plane if no caster is nearer: near enough for moving objects, and far enough for exact depths of triangles
/// that pass the light.
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
