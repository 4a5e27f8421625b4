// SPDX-License-Identifier: Apache-2.0
// Specular-glossiness to metallic-roughness, of one colour.
#pragma once

#include <glm/glm.hpp>

namespace chandelier::baker {

/// What any surface that is no metal reflects, as glTF has it.
inline constexpr float dielectric = 0.04f;

/// All linear. Roughness is 1 - glossiness.
struct MetallicColor {
  glm::vec3 base_color{0};
  float metallic = 0;
};

/// The base colour and metallic that reflect as much as a diffuse and a specular colour do: exactly where these are
/// grey or a metal's; else what is lost is the hue of a mirror that is no metal.
MetallicColor metallic_color(const glm::vec3& diffuse, const glm::vec3& specular);

/// What reflects no more than any surface that is no metal: its metallic is 0 whatever its diffuse colour.
bool is_dielectric(const glm::vec3& specular);

}  // namespace chandelier::baker
