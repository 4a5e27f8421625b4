// SPDX-License-Identifier: Apache-2.0
// A material's factors and its five textures (set 1), as glTF combines them.
#ifndef CHANDELIER_MATERIAL_GLSL
#define CHANDELIER_MATERIAL_GLSL

layout(set = 1, binding = 0) uniform sampler2D base_color_map;
layout(set = 1, binding = 1) uniform sampler2D metallic_roughness_map;
layout(set = 1, binding = 2) uniform sampler2D normal_map;
layout(set = 1, binding = 3) uniform sampler2D occlusion_map;
layout(set = 1, binding = 4) uniform sampler2D emissive_map;

// `texture_number`: 0 to 4 in the order above.
vec2 uv_of(Material m, uint texture_number, vec4 uv0_uv1) {
  return (m.uv1_mask >> texture_number & 1u) != 0u ? uv0_uv1.zw : uv0_uv1.xy;
}

#endif
