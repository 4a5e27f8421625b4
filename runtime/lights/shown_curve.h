// SPDX-License-Identifier: Apache-2.0
// shading/tone_map.comp on the CPU: from exposed linear radiance to what a screen shows, 0 to 1.
#pragma once

#include <glm/glm.hpp>
#include <vector>

namespace chandelier {

float shown(float exposed);
inline glm::vec3 shown(const glm::vec3& exposed) {
  return {shown(exposed.x), shown(exposed.y), shown(exposed.z)};
}

/// The same by a table, for searches: within 3e-4.
class ShownCurve {
 public:
  ShownCurve();
  float operator()(float exposed) const;

 private:
  std::vector<float> values_;
};

}  // namespace chandelier
