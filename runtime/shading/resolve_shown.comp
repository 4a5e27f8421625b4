// SPDX-License-Identifier: Apache-2.0
// What a screen shows of edge pixels: each surface is tone-mapped before the mean is taken, so that a lamp in a quarter of a
// pixel makes a quarter of it white, not all of it.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shading/resolve_edges.glsl"
#include "shading/tone_map.glsl"

layout(binding = 3, scalar) readonly buffer Sums { LuminanceSum sums[]; };
layout(binding = 4, rgba8) uniform writeonly image2D shown_image;

vec3 value_of(vec4 radiance) { return shown_linear(radiance, sums[0].exposure_ev); }

void main() {
  ivec2 pixel;
  uint number = first_of_pixel(pixel);
  if (number != NO_SURFACE) imageStore(shown_image, pixel, vec4(srgb(mean_of_pixel(number).rgb), 1.0));
}
