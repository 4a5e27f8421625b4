// SPDX-License-Identifier: Apache-2.0
// glTF gives both models a diffuse colour c and a reflectance f at normal incidence
// (KHR_materials_pbrSpecularGlossiness, and glTF 2.0 with the dielectric's 0.04):
//
//   c = diffuse (1 - max(specular)) = base (1 - 0.04) (1 - metallic)
//   f = specular                    = 0.04 (1 - metallic) + base metallic
//
// Without `base`, for one brightness of each, with d = c / 0.96:
//
//   0.04 metallic^2 + (d + specular - 0.08) metallic + 0.04 - specular = 0
//
// which is what the extension's appendix solves ("Conversion between the two PBR material models"). Each equation then
// gives a base colour; they are mixed by the square of metallic, as there.
#include "specular_glossiness.h"

#include <algorithm>
#include <cmath>

namespace chandelier::baker {
namespace {

constexpr float least = 1e-6f;

/// As bright as it seems (HSP, Finley 2006).
float brightness(const glm::vec3& color) {
  return std::sqrt(glm::dot(glm::vec3(0.299f, 0.587f, 0.114f), color * color));
}

float solve_metallic(float d, float specular) {
  if (specular <= dielectric) return 0;
  const float half = (d + specular - 2 * dielectric) / 2;
  // The larger root: the smaller one is negative.
  const float root = std::sqrt(half * half + dielectric * (specular - dielectric)) - half;
  return std::clamp(root / dielectric, 0.0f, 1.0f);
}

}  // namespace

bool is_dielectric(const glm::vec3& specular) {
  return brightness(specular) <= dielectric + least;
}

MetallicColor metallic_color(const glm::vec3& diffuse, const glm::vec3& specular) {
  const float left = 1 - std::max({specular.r, specular.g, specular.b});  // for the diffuse colour
  const glm::vec3 d = diffuse * (left / (1 - dielectric));
  MetallicColor out;
  out.metallic = is_dielectric(specular) ? 0 : solve_metallic(brightness(d), brightness(specular));
  const glm::vec3 by_diffuse = d / std::max(1 - out.metallic, least);
  const glm::vec3 by_specular = (specular - dielectric * (1 - out.metallic)) / std::max(out.metallic, least);
  out.base_color = glm::clamp(glm::mix(by_diffuse, by_specular, out.metallic * out.metallic), 0.0f, 1.0f);
  return out;
}

}  // namespace chandelier::baker
