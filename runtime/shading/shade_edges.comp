// SPDX-License-Identifier: Apache-2.0
// Adds the light of one group's ShadowMaps to the surfaces of edge pixels: one in each thread, at the first of its samples.
// Shadow maps are filtered here whatever the delivery is; with filter rays each surface has bytes of its own.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shading/group.glsl"
#include "shading/edges.glsl"
#include "shading/shade.glsl"

layout(constant_id = 110) const uint samples = 4u;
layout(binding = 13) uniform usampler2DMS surface_samples;
layout(binding = 14) uniform sampler2DMS depth_samples;
layout(binding = 15, scalar) buffer EdgeSurfaces { EdgeSurface edge_surfaces[]; };
layout(binding = 16, scalar) readonly buffer EdgeGroups { EdgeGroup edge_groups[]; };
layout(binding = 17, scalar) readonly buffer Counters { EdgeCounters counters; };

uvec2 tile;
uvec2 tile_of_group() { return tile; }

// `place.x`: its number among those that have bytes.
float visible_part(uint number, Receiver receiver, uvec2 place) {
  if (filter_answer != FILTER_RAYS) return visibility(maps[number], receiver);
  uint first_map = lights[group.first_light].map;
  uint byte = (number - first_map) * group.edge_count + place.x;
  return in_range(maps[number], receiver.p) ? float(uint(visibility_bytes[byte])) / 255.0 : 0.0;
}

void main() {
  if (group_number() >= counters.groups || group.first_light == group.light_end) return;
  EdgeGroup own = edge_groups[group_number()];
  tile = tile_at(own.tile, group.tiles_x);
  uint number = own.first + gl_LocalInvocationIndex;
  if (gl_LocalInvocationIndex >= own.count) return;
  if (filter_answer == FILTER_RAYS && number - group.first_edge >= group.edge_count) return;
  uint place = edge_surfaces[number].place;
  if ((place & EDGE_UNLIT) != 0u) return;
  ivec2 pixel = ivec2(edge_pixel(place, tile));
  uint one = findLSB(edge_samples(place));
  Surface s = unpack_surface(texelFetch(surface_samples, pixel, int(one)));
  float depth = texelFetch(depth_samples, pixel, int(one)).r;
  vec3 p = eye_position(view, vec2(pixel) + sample_place(samples, one), depth);
  edge_surfaces[number].radiance += lit_by_group(s, p, uvec2(number - group.first_edge, 0u));
}
