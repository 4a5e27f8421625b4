// SPDX-License-Identifier: Apache-2.0
// What the radiance image's alpha holds: the same in shading/occlusion.glsl.
#pragma once

namespace chandelier {

/// The colour is what the screen shall show (KHR_materials_unlit).
constexpr float unlit_alpha = 0.0f;

/// `occlusion`: of the material, from 0 (closed in) to 1 (open).
constexpr float alpha_of_occlusion(float occlusion) {
  return 1.0f + occlusion;
}

/// Of an alpha that is not unlit. To within 2^-24, since alpha lies between 1 and 2. In a pixel of which a part shows
/// unlit surfaces alpha is below 1, the part that does not (resolve_radiance.comp): 0.
constexpr float occlusion_of_alpha(float alpha) {
  return alpha > 1.0f ? alpha - 1.0f : 0.0f;
}

constexpr bool is_unlit(float alpha) {
  return alpha == unlit_alpha;
}

}  // namespace chandelier
