// SPDX-License-Identifier: Apache-2.0
// How far a light is from a centre whose shadow map it might take.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <glm/glm.hpp>

namespace chandelier::lights {

/// What clustering knows of a light. World space, metres; finite, the range not negative.
struct ClusterLight {
  glm::vec3 position_ws;
  float range_m;
  glm::vec3 axis_ws{0.0f, -1.0f, 0.0f};  // the way a spot light shines, unit length
  float cone_cos = -1.0f;                // cosine of a spot light's outer half angle; -1 shines all around
  bool dynamic = false;                  // something moves it
  bool unclustered = false;              // its author wants a shadow map of its own
  uint32_t group = 0;                    // lights of one group share one map, with nobody else; 0: of none
  uint32_t priority = 128;               // 0 to 255: higher ones are selected first
};

// Double precision: no distance between finite positions overflows, and the order of evaluation is the same wherever a
// distance is compared with another.
inline double squared_length(const glm::dvec3& v) {
  return v.x * v.x + v.y * v.y + v.z * v.z;
}

inline double straight_distance_m(const glm::vec3& a, const glm::vec3& b) {
  return std::sqrt(squared_length(glm::dvec3(a) - glm::dvec3(b)));
}

/// A light's greatest straight distance over its metric distance from any centre.
inline double straight_per_metric(const ClusterLight& light) {
  return light.cone_cos > 0.0f ? 2.0 : 1.0;
}

/// Seen from a receiver in direction w, a light that moves by D moves across the view by |D| sin(D, w). Metric distance
/// is the most of it over all receivers of the light, but at least |D| / 2, for parallax is not all: what stands
/// between both positions shadows one of them only. For a point light that is |D|, LightCluster's metric. For a cone of
/// half angle t < 90 degrees whose axis and D span the angle f as lines, it is |D| sin(min(90 degrees, f + t)).
inline double metric_distance_m(const ClusterLight& light, const glm::vec3& center_ws) {
  const glm::dvec3 offset = glm::dvec3(center_ws) - glm::dvec3(light.position_ws);
  const double straight = std::sqrt(squared_length(offset));
  if (light.cone_cos <= 0.0f) return straight;
  const double cone_cos = light.cone_cos;
  const double cone_sin = std::sqrt(std::max(0.0, 1.0 - cone_cos * cone_cos));
  const glm::dvec3 axis(light.axis_ws);
  const double along = std::abs(glm::dot(offset, axis));
  if (along <= straight * cone_sin) return straight;
  const double across = std::sqrt(squared_length(glm::cross(offset, axis)));
  return std::clamp(across * cone_cos + along * cone_sin, 0.5 * straight, straight);
}

}  // namespace chandelier::lights
