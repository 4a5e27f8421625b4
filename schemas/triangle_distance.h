// SPDX-License-Identifier: Apache-2.0
// The distance of a triangle: one rule for the baker and for lights that move later.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <glm/glm.hpp>

namespace chandelier::pack {

using Triangle = std::array<glm::dvec3, 3>;

/// From the origin.
inline double distance_to_segment(const glm::dvec3& a, const glm::dvec3& b) {
  const glm::dvec3 along = b - a;
  const double length2 = glm::dot(along, along);
  const double t = length2 > 0 ? std::clamp(-glm::dot(a, along) / length2, 0.0, 1.0) : 0;
  return glm::length(a + along * t);
}

/// From the origin.
inline double distance_to_triangle(const Triangle& t) {
  double least = INFINITY;
  bool inside = true;
  const glm::dvec3 normal = glm::cross(t[1] - t[0], t[2] - t[0]);
  for (size_t i = 0; i < 3; ++i) {
    const glm::dvec3 &a = t[i], &b = t[(i + 1) % 3];
    least = std::min(least, distance_to_segment(a, b));
    inside = inside && glm::dot(glm::cross(b - a, -a), normal) >= 0;
  }
  const double length = glm::length(normal);
  return inside && length > 0 ? std::abs(glm::dot(t[0], normal)) / length : least;
}

}  // namespace chandelier::pack
