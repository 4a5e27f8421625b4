// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <glm/glm.hpp>

namespace chandelier {

/// An axis-aligned box in the world, metres.
struct Bounds {
  glm::vec3 min_ws{0.0f};
  glm::vec3 max_ws{0.0f};
};

inline Bounds enclosing(const Bounds& a, const Bounds& b) {
  return {glm::min(a.min_ws, b.min_ws), glm::max(a.max_ws, b.max_ws)};
}

}  // namespace chandelier
