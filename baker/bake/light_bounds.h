// SPDX-License-Identifier: Apache-2.0
// Bounding spheres of the volumes that lights reach.
#pragma once

#include <glm/glm.hpp>

#include "pack_schema.h"

namespace chandelier::baker {

struct Sphere {
  glm::dvec3 center{0};
  double radius = 0;
};

/// The smallest sphere around the volume that a point or spot light reaches: a ball with its range as radius, cut to
/// its cone.
Sphere light_bounds(const pack::Light& light);

/// The smallest sphere around both.
Sphere enclosing(const Sphere& a, const Sphere& b);

/// Rounds to floats: the centre to the nearest, and the radius up, so that the sphere still holds the volume. Both are
/// finite.
struct FloatSphere {
  glm::vec3 center;
  float radius;
};
FloatSphere rounded_outwards(const Sphere& sphere);

}  // namespace chandelier::baker
