// SPDX-License-Identifier: Apache-2.0
// What hierarchies are built over, and batches made of.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>

namespace chandelier::baker {

/// What a hierarchy is built over: a box, whose it is, and a triangle's area. Without a constructor, so that arrays of
/// many are first touched by the threads that fill them.
struct BvhItem {
  glm::vec3 low;
  uint32_t number;
  glm::vec3 high;
  float area_m2;
};
static_assert(sizeof(BvhItem) == 32);

}  // namespace chandelier::baker
