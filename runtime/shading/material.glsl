// SPDX-License-Identifier: Apache-2.0
// A material's five textures (set 1).
#ifndef CHANDELIER_MATERIAL_GLSL
#define CHANDELIER_MATERIAL_GLSL

layout(set = 1, binding = 0) uniform sampler2D base_color_map;
layout(set = 1, binding = 1) uniform sampler2D metallic_roughness_map;
layout(set = 1, binding = 2) uniform sampler2D normal_map;
layout(set = 1, binding = 3) uniform sampler2D occlusion_map;
layout(set = 1, binding = 4) uniform sampler2D emissive_map;

// A normal map's texel: z is not stored in all formats, so it comes from x and y.
vec3 unit_normal(vec2 stored) {
  vec2 xy = stored * 2.0 - 1.0;
  return vec3(xy, sqrt(max(1.0 - dot(xy, xy), 0.0)));
}

#endif
