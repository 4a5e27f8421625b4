// SPDX-License-Identifier: Apache-2.0
// Filter answer `rays`: the caller says how much of a light reaches each visible point, where shadow maps would be
// asked.
#pragma once

#include <cstdint>
#include <functional>
#include <glm/glm.hpp>
#include <span>

#include "frame_schema.h"

namespace chandelier {

/// What the camera sees in a pixel.
struct SurfacePoint {
  glm::vec3 position;   // from the camera's eye, along the world's axes
  glm::vec3 normal_ws;  // of the triangle, unit length, facing the camera; zero where nothing is seen
};

/// One light and the points that its range may reach. `visibility` has a byte for each point: 255 is fully lit.
struct VisibilityQuery {
  const frame::FrameLight& light;
  float near_m;    // what is nearer to the light casts no shadow; unused for a directional light
  float radius_m;  // of the sphere that shines; of a directional light, of its disc a metre away
  glm::vec3 eye_ws;
  std::span<const SurfacePoint> points;
  std::span<uint8_t> visibility;
};
/// Answers queries; empty where nothing does. Two are equal only where both are empty.
struct VisibilitySource : std::function<void(const VisibilityQuery&)> {
  using std::function<void(const VisibilityQuery&)>::function;
  friend bool operator==(const VisibilitySource& a, const VisibilitySource& b) { return !a && !b; }
};

}  // namespace chandelier
