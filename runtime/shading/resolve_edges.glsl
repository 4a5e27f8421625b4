// SPDX-License-Identifier: Apache-2.0
// What an edge pixel shows: the mean over its samples of what its surfaces show. Samples without a surface are black.
#ifndef CHANDELIER_RESOLVE_EDGES_GLSL
#define CHANDELIER_RESOLVE_EDGES_GLSL
#include "frame_schema.glsl"
#include "shading/edges.glsl"
#include "shading/occlusion.glsl"

layout(constant_id = 0) const uint samples = 4u;
layout(local_size_x = EDGE_GROUP_SIZE) in;
layout(binding = 0, scalar) readonly buffer EdgeSurfaces { EdgeSurface edge_surfaces[]; };
layout(binding = 1, scalar) readonly buffer EdgeGroups { EdgeGroup edge_groups[]; };
layout(binding = 2, scalar) readonly buffer Counters { EdgeCounters counters; };
layout(push_constant, scalar) uniform Push { EdgeConstants edges; };

// Of a surface, whose alpha is as in shading/occlusion.glsl.
vec3 value_of(vec4 radiance);

// The surface that this thread takes, if it is the first one of a pixel; else NO_SURFACE.
const uint NO_SURFACE = 0xFFFFFFFFu;
uint first_of_pixel(out ivec2 pixel) {
  if (group_number() >= counters.groups) return NO_SURFACE;
  EdgeGroup own = edge_groups[group_number()];
  if (gl_LocalInvocationIndex >= own.count) return NO_SURFACE;
  uint number = own.first + gl_LocalInvocationIndex;
  uint place = edge_surfaces[number].place;
  pixel = ivec2(edge_pixel(place, tile_at(own.tile, edges.tiles_x)));
  return (place & EDGE_FIRST) != 0u ? number : NO_SURFACE;
}

// Alpha is the part of the pixel that is not unlit. All threads take as many steps: lavapipe 22 goes on adding up in threads that
// have left a loop before others.
vec4 mean_of_pixel(uint number) {
  vec3 sum = vec3(0.0);
  uint unlit = 0u;
  bool of_pixel = true;
  for (uint i = 0u; i < samples; ++i) {
    EdgeSurface surface = edge_surfaces[min(number + i, counters.surfaces - 1u)];
    of_pixel = of_pixel && (i == 0u || (number + i < counters.surfaces && (surface.place & EDGE_FIRST) == 0u));
    uint count = of_pixel ? bitCount(edge_samples(surface.place)) : 0u;
    bool unlit_one = (surface.place & EDGE_UNLIT) != 0u;
    vec3 value = value_of(vec4(surface.radiance, unlit_one ? UNLIT_ALPHA : alpha_of_occlusion(1.0)));
    sum += of_pixel ? float(count) * value : vec3(0.0);
    unlit += unlit_one ? count : 0u;
  }
  return vec4(sum / float(samples), 1.0 - float(unlit) / float(samples));
}

#endif
