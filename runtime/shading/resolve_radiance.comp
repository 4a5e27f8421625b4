// SPDX-License-Identifier: Apache-2.0
// The linear radiance of edge pixels. Where unlit surfaces take part, alpha is the part of the pixel that is not unlit: below 1.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shading/resolve_edges.glsl"

layout(binding = 3, rgba32f) uniform image2D radiance_image;

vec3 value_of(vec4 radiance) { return radiance.rgb; }

void main() {
  ivec2 pixel;
  uint number = first_of_pixel(pixel);
  if (number == NO_SURFACE) return;
  vec4 mean = mean_of_pixel(number);
  if (mean.a == 1.0) mean.a = imageLoad(radiance_image, pixel).a;
  imageStore(radiance_image, pixel, mean);
}
