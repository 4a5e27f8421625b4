// SPDX-License-Identifier: Apache-2.0
// From a mesh's texture coordinates to an image's (KHR_texture_transform). For vertex shaders: lavapipe 22 reads zeros from
// buffers in the helper pixels beside a triangle, and coordinates made of those take textures at the wrong level.
#ifndef CHANDELIER_UV_TRANSFORM_GLSL
#define CHANDELIER_UV_TRANSFORM_GLSL

// Ten rows a material, two for each of its five textures: scene/textures.cpp.
layout(binding = 4, scalar) readonly buffer UvTransforms { vec3 uv_rows[]; };

// `texture_number`: 0 base colour, 1 metallic-roughness, 2 normal, 3 occlusion, 4 emissive.
vec2 uv_of(uint uv1_mask, uint material, uint texture_number, vec2 uv0, vec2 uv1) {
  vec3 uv = vec3((uv1_mask >> texture_number & 1u) != 0u ? uv1 : uv0, 1.0);
  uint row = 10u * material + 2u * texture_number;
  return vec2(dot(uv_rows[row], uv), dot(uv_rows[row + 1u], uv));
}

#endif
