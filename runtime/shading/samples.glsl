// SPDX-License-Identifier: Apache-2.0
// The g-buffer's samples, and when two of them show the same surface. Expects `samples` and `same_depth` in scope.
#ifndef CHANDELIER_SAMPLES_GLSL
#define CHANDELIER_SAMPLES_GLSL
#include "shading/occlusion.glsl"
#include "shading/surface.glsl"

layout(binding = 0) uniform usampler2DMS surface_samples;
layout(binding = 1) uniform sampler2DMS radiance_samples;
layout(binding = 8) uniform sampler2DMS middle_depth_samples;

struct Sample {
  uvec4 bits;     // shading/surface.glsl
  vec4 radiance;  // shading/occlusion.glsl
  float depth;    // in the middle of the pixel; 0 where nothing is seen
};

Sample sample_at(ivec2 pixel, uint i) {
  return Sample(texelFetch(surface_samples, pixel, int(i)), texelFetch(radiance_samples, pixel, int(i)),
                texelFetch(middle_depth_samples, pixel, int(i)).r);
}

// How far apart two samples of one surface may be. Triangles of a bent mesh meet within pixels, and are to count as one.
const float LEAST_COSINE = 0.995;       // of the normals that are shaded
const float LEAST_FACET_COSINE = 0.9;   // of the triangles' own; as in shadows/filter/block.glsl
const float MOST_COLOR = 0.03;          // square roots of base colour
const float MOST_METAL_ROUGH = 0.05;
const float MOST_RADIANCE = 0.05;       // of the brighter one

vec3 color_root(uint bits) { return vec3(bits & 1023u, bits >> 10 & 1023u, bits >> 20 & 1023u) / 1023.0; }

bool same_radiance(vec3 a, vec3 b) {
  return all(lessThanEqual(abs(a - b), MOST_RADIANCE * max(abs(a), abs(b)) + 1e-6));
}

bool same_surface(Sample a, Sample b) {
  bool seen = a.depth > 0.0;
  bool unlit = is_unlit(a.radiance.a);
  bool alike = seen == b.depth > 0.0 && unlit == is_unlit(b.radiance.a) && same_radiance(a.radiance.rgb, b.radiance.rgb);
  bool near = abs(a.depth - b.depth) <= same_depth * max(a.depth, b.depth);
  bool even = dot(decode_normal(a.bits.x), decode_normal(b.bits.x)) >= LEAST_COSINE &&
              dot(decode_normal(a.bits.y), decode_normal(b.bits.y)) >= LEAST_FACET_COSINE;
  bool colored = all(lessThanEqual(abs(color_root(a.bits.z) - color_root(b.bits.z)), vec3(MOST_COLOR))) &&
                 all(lessThanEqual(abs(unpackUnorm2x16(a.bits.w) - unpackUnorm2x16(b.bits.w)), vec2(MOST_METAL_ROUGH)));
  return alike && (!seen || unlit || (near && even && colored));
}

#endif
