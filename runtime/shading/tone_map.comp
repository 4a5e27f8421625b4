// SPDX-License-Identifier: Apache-2.0
// Linear radiance to what a screen shows: exposure, a filmic curve, sRGB; unlit colours by sRGB alone.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "frame_schema.glsl"
#include "shading/occlusion.glsl"

layout(local_size_x = 8, local_size_y = 8) in;
layout(binding = 0, rgba32f) uniform readonly image2D radiance_image;
layout(binding = 1, scalar) readonly buffer Sums { LuminanceSum sums[]; };
layout(binding = 2, rgba8) uniform writeonly image2D shown_image;

// Narkowicz 2015, ACES Filmic Tone Mapping Curve.
vec3 filmic(vec3 x) { return clamp(x * (2.51 * x + 0.03) / (x * (2.43 * x + 0.59) + 0.14), 0.0, 1.0); }

// IEC 61966-2-1
vec3 srgb(vec3 x) { return mix(x * 12.92, 1.055 * pow(x, vec3(1.0 / 2.4)) - 0.055, greaterThan(x, vec3(0.0031308))); }

void main() {
  ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  if (any(greaterThanEqual(pixel, imageSize(shown_image)))) return;
  vec4 radiance = imageLoad(radiance_image, pixel);
  vec3 exposed = min(radiance.rgb * exp2(sums[0].exposure_ev), vec3(1e4));  // white long before
  vec3 shown = is_unlit(radiance.a) ? clamp(radiance.rgb, 0.0, 1.0) : filmic(exposed);
  imageStore(shown_image, pixel, vec4(srgb(shown), 1.0));
}
