// SPDX-License-Identifier: Apache-2.0
// Spheres around what lights reach.
#pragma once

#include <glm/glm.hpp>

#include "pack_schema.h"

namespace chandelier::baker {

struct Sphere {
  glm::dvec3 center{0};
  double radius = 0;
};

/// The smallest sphere around all that a point or spot light reaches: its range, cut to its cone.
Sphere light_bounds(const pack::Light& light);

/// The smallest sphere around both.
Sphere enclosing(const Sphere& a, const Sphere& b);

/// In floats: the nearest centre, and a radius that is large enough for it. Both are finite.
struct FloatSphere {
  glm::vec3 center;
  float radius;
};
FloatSphere rounded_outwards(const Sphere& sphere);

}  // namespace chandelier::baker
