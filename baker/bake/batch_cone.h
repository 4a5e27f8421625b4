// SPDX-License-Identifier: Apache-2.0
// The normal cone of a batch: the eyes from which all of its triangles are seen from the back.
#pragma once

#include <glm/glm.hpp>
#include <span>

namespace chandelier::baker {

/// As pack::Batch has it: seen from an eye with dot(normalize(apex − eye), axis) ≥ cutoff, no triangle shows its front.
struct NormalCone {
  glm::vec3 apex{0};
  glm::vec3 axis{0};
  float cutoff = 1;  // 1, with a zero axis: never
};

/// `corners`: three of each triangle, counter-clockwise from its front; each triangle has an area.
NormalCone normal_cone(std::span<const glm::vec3> corners);

}  // namespace chandelier::baker
