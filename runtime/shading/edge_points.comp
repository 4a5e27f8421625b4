// SPDX-License-Identifier: Apache-2.0
// Where the surfaces of edge pixels are, for rays on the CPU: as shade_edges.comp has them.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "frame_schema.glsl"
#include "shading/edges.glsl"
#include "shading/eye_position.glsl"
#include "shading/surface.glsl"

layout(constant_id = 0) const uint samples = 4u;
layout(local_size_x = EDGE_GROUP_SIZE) in;
layout(binding = 0, scalar) readonly buffer View { ViewConstants view; };
layout(binding = 1) uniform usampler2DMS surface_samples;
layout(binding = 2) uniform sampler2DMS depth_samples;
layout(binding = 3, scalar) readonly buffer EdgeSurfaces { EdgeSurface edge_surfaces[]; };
layout(binding = 4, scalar) readonly buffer EdgeGroups { EdgeGroup edge_groups[]; };
layout(binding = 5, scalar) readonly buffer Counters { EdgeCounters counters; };
layout(binding = 6, scalar) writeonly buffer EdgePoints { EdgePoint points[]; };
layout(push_constant, scalar) uniform Push { EdgeConstants edges; };

void main() {
  if (group_number() >= counters.groups) return;
  EdgeGroup own = edge_groups[group_number()];
  if (gl_LocalInvocationIndex >= own.count) return;
  uint number = own.first + gl_LocalInvocationIndex;
  uint place = edge_surfaces[number].place;
  ivec2 pixel = ivec2(edge_pixel(place, tile_at(own.tile, edges.tiles_x)));
  uint one = findLSB(edge_samples(place));
  vec3 n = decode_normal(texelFetch(surface_samples, pixel, int(one)).y);
  float depth = texelFetch(depth_samples, pixel, int(one)).r;
  points[number].position = eye_position(view, vec2(pixel) + sample_place(samples, one), depth);
  points[number].normal_ws = (place & EDGE_UNLIT) != 0u ? vec3(0.0) : n;
}
