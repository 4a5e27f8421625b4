// SPDX-License-Identifier: Apache-2.0
// The normal cone of a batch: the eye positions from which all triangles of the batch are back-facing.
#pragma once

#include <glm/glm.hpp>
#include <span>

namespace chandelier::baker {

/// The fields of pack::Batch: all triangles are back-facing for an eye with dot(normalize(apex − eye), axis) ≥ cutoff.
struct NormalCone {
  glm::vec3 apex{0};
  glm::vec3 axis{0};
  float cutoff = 1;  // 1, with a zero axis: the cone never culls
};

/// `corners`: three of each triangle, counter-clockwise from its front; each triangle has an area.
NormalCone normal_cone(std::span<const glm::vec3> corners);

}  // namespace chandelier::baker
