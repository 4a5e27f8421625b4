// SPDX-License-Identifier: Apache-2.0
// Apart from mean_materials.cpp, so that what links only this needs no decoder of images.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "lights/mean_materials.h"

namespace chandelier {

glm::vec3 reflected(const MeanMaterial& s, const glm::vec3& normal, const glm::vec3& to_eye,
                    const glm::vec3& to_light) {
  const glm::vec3 h = glm::normalize(to_eye + to_light);
  const float n_dot_l = glm::dot(normal, to_light);
  const float n_dot_v = std::max(glm::dot(normal, to_eye), 1e-4f);
  const float n_dot_h = glm::clamp(glm::dot(normal, h), 0.0f, 1.0f);
  const float v_dot_h = glm::clamp(glm::dot(to_eye, h), 0.0f, 1.0f);
  const float a = std::max(s.roughness * s.roughness, 0.002f);
  const float a2 = a * a;
  const float d_root = (n_dot_h * a2 - n_dot_h) * n_dot_h + 1.0f;
  const float d = a2 / (std::numbers::pi_v<float> * d_root * d_root);
  const float smith = n_dot_l * std::sqrt((n_dot_v - n_dot_v * a2) * n_dot_v + a2) +
                      n_dot_v * std::sqrt((n_dot_l - n_dot_l * a2) * n_dot_l + a2);
  const float v = 0.5f / std::max(smith, 1e-6f);
  const glm::vec3 f0 = glm::mix(glm::vec3(0.04f), s.base_color, s.metallic);
  const glm::vec3 f = f0 + (1.0f - f0) * std::pow(1.0f - v_dot_h, 5.0f);
  const glm::vec3 diffuse = s.base_color * ((1.0f - s.metallic) / std::numbers::pi_v<float>);
  return (1.0f - f) * diffuse + f * (d * v);
}

}  // namespace chandelier
