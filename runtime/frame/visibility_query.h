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
  glm::vec3 position_ws;
  glm::vec3 normal_ws;  // of the triangle, unit length, facing the camera; zero where nothing is seen
};

/// One light and the points that its range may reach. `visibility` has a byte for each point: 255 is fully lit.
struct VisibilityQuery {
  const frame::FrameLight& light;
  float radius_m;  // of the sphere that shines; of a directional light, of its disc a metre away
  std::span<const SurfacePoint> points;
  std::span<uint8_t> visibility;
};
using VisibilitySource = std::function<void(const VisibilityQuery&)>;

}  // namespace chandelier
