// SPDX-License-Identifier: Apache-2.0
// Casters with an alpha test: what is cut out of the surface is cut out of its shadow.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shading/material.glsl"

layout(location = 0) in vec2 uv;
layout(location = 1) in float alpha;
layout(location = 2) flat in float alpha_cutoff;

void main() {
  if (alpha * texture(base_color_map, uv).a < alpha_cutoff) discard;
}
