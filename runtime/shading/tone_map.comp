// SPDX-License-Identifier: Apache-2.0
// Linear radiance to what a screen shows: exposure, a filmic curve, sRGB; unlit colours by sRGB alone. Pixels whose
// samples show several surfaces follow in resolve_shown.comp.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "frame_schema.glsl"
#include "shading/tone_map.glsl"

layout(local_size_x = 8, local_size_y = 8) in;
layout(binding = 0, rgba32f) uniform readonly image2D radiance_image;
layout(binding = 1, scalar) readonly buffer Sums { LuminanceSum sums[]; };
layout(binding = 2, rgba8) uniform writeonly image2D shown_image;

void main() {
  ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  if (any(greaterThanEqual(pixel, imageSize(shown_image)))) return;
  vec4 radiance = imageLoad(radiance_image, pixel);
  imageStore(shown_image, pixel, vec4(srgb(shown_linear(radiance, sums[0].exposure_ev)), 1.0));
}
