// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <glm/glm.hpp>

namespace chandelier {

/// Of a whole scene.
struct Bounds {
  glm::vec3 min_ws{0.0f};
  glm::vec3 max_ws{0.0f};
};

}  // namespace chandelier
