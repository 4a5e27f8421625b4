// SPDX-License-Identifier: Apache-2.0
// Sums square roots of luminance: pass 0 a sum per 16 x 16 pixels, pass 1 all sums into the picture's exposure. The mean
// of roots lies between the log mean, which dark corners of a night scene drag up, and the plain mean, which lamps in view
// drag down. Sums are taken in a fixed order, so that the same picture gets the same exposure.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "frame_schema.glsl"
#include "shading/occlusion.glsl"

layout(constant_id = 0) const uint pass = 0u;
layout(local_size_x = 256) in;
layout(binding = 0, rgba32f) uniform readonly image2D radiance_image;
layout(binding = 1, scalar) buffer Sums { LuminanceSum sums[]; };
layout(push_constant, scalar) uniform Push { ToneConstants tone; };

const float MIDDLE_GREY = 0.18;
const float DARKEST = 1e-6;  // pixels that no light reaches do not count

shared vec2 partial[256];

vec2 of_pixel(uvec2 group, uint thread) {
  ivec2 pixel = ivec2(group) * 16 + ivec2(thread % 16u, thread / 16u);
  if (any(greaterThanEqual(pixel, imageSize(radiance_image)))) return vec2(0.0);
  vec4 radiance = imageLoad(radiance_image, pixel);
  if (radiance.a < 1.0) return vec2(0.0);  // unlit, or partly so: not radiance
  float luminance = dot(radiance.rgb, vec3(0.2126, 0.7152, 0.0722));
  return luminance > DARKEST && luminance < 1e30 ? vec2(sqrt(luminance), 1.0) : vec2(0.0);
}

void main() {
  uint thread = gl_LocalInvocationID.x;
  vec2 sum = vec2(0.0);
  if (pass == 0u)
    sum = of_pixel(gl_WorkGroupID.xy, thread);
  else
    for (uint i = thread; i < tone.group_count; i += 256u) sum += vec2(sums[i].sum, sums[i].pixels);
  partial[thread] = sum;
  for (uint half_size = 128u; half_size > 0u; half_size /= 2u) {
    barrier();
    if (thread < half_size) partial[thread] += partial[thread + half_size];
  }
  if (thread != 0u) return;
  if (pass == 0u) {
    uint group = gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x;
    sums[group].sum = partial[0].x;
    sums[group].pixels = partial[0].y;
  } else {
    float automatic = partial[0].x > 0.0 ? log2(MIDDLE_GREY) - 2.0 * log2(partial[0].x / partial[0].y) : 0.0;
    sums[0].exposure_ev = tone.automatic != 0u ? automatic : tone.exposure_ev;
  }
}
