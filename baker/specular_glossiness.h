// SPDX-License-Identifier: Apache-2.0
// Specular-glossiness to metallic-roughness, of one colour.
#pragma once

#include <glm/glm.hpp>

namespace chandelier::baker {

/// The reflectance of any surface that is not metal, in glTF.
inline constexpr float dielectric = 0.04f;

/// All linear. Roughness is 1 - glossiness.
struct MetallicColor {
  glm::vec3 base_color{0};
  float metallic = 0;
};

/// The base colour and metallic that reflect as much as a diffuse and a specular colour. Exact for grey colours and for
/// metals; otherwise the hue of a mirror that is not metal is lost.
MetallicColor metallic_color(const glm::vec3& diffuse, const glm::vec3& specular);

/// Whether the surface reflects no more than a non-metal: its metallic is then 0, whatever its diffuse colour.
bool is_dielectric(const glm::vec3& specular);

}  // namespace chandelier::baker
