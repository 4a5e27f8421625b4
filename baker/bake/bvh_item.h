// SPDX-License-Identifier: Apache-2.0
// The items that hierarchies and batches are built from.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>

namespace chandelier::baker {

/// An item of a hierarchy: a box, the number of its owner, and a triangle's area. It has no constructor, so that the
/// memory of large arrays is first touched by the threads that fill it.
struct BvhItem {
  glm::vec3 low;
  uint32_t number;
  glm::vec3 high;
  float area_m2;
};
static_assert(sizeof(BvhItem) == 32);

}  // namespace chandelier::baker
