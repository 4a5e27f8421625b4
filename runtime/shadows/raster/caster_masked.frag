// SPDX-License-Identifier: Apache-2.0
// Casters with an alpha test: what is cut out of the surface is cut out of its shadow.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "frame_schema.glsl"
#include "pack_schema.glsl"
#include "shading/material.glsl"

layout(binding = 3, scalar) readonly buffer Materials { Material materials[]; };

layout(location = 0) in vec4 uv0_uv1;
layout(location = 1) in float alpha;
layout(location = 2) flat in uint material_number;

void main() {
  Material m = materials[material_number];
  float a = m.base_color_factor.a * alpha * texture(base_color_map, uv_of(m, 0u, uv0_uv1)).a;
  if (a < m.alpha_cutoff) discard;
}
