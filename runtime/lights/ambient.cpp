// SPDX-License-Identifier: Apache-2.0
#include "lights/ambient.h"

#include <algorithm>

namespace chandelier {

Ambient Ambient::constant(float radiance) {
  Ambient ambient;
  ambient.coefficients[0] = glm::vec3(radiance);
  return ambient;
}

// Light of radiance y from each direction gives a surface an irradiance over pi of 2/3 of its normal's y.
Ambient Ambient::between(float up, float down) {
  Ambient ambient = constant(0.5f * (up + down));
  ambient.coefficients[1] = glm::vec3(2.0f / 3.0f * 0.5f * (up - down));
  return ambient;
}

glm::vec3 Ambient::at(const glm::vec3& n) const {
  const auto& c = coefficients;
  const glm::vec3 first = c[1] * n.y + c[2] * n.z + c[3] * n.x;
  const glm::vec3 second = c[4] * (n.x * n.y) + c[5] * (n.y * n.z) + c[6] * (3.0f * n.z * n.z - 1.0f) +
                           c[7] * (n.x * n.z) + c[8] * (n.x * n.x - n.y * n.y);
  return glm::max(c[0] + first + second, 0.0f);
}

bool Ambient::is_constant() const {
  return std::all_of(coefficients.begin() + 1, coefficients.end(),
                     [](const glm::vec3& c) { return c == glm::vec3(0); });
}

}  // namespace chandelier
