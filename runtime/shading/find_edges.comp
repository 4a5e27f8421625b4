// SPDX-License-Identifier: Apache-2.0
// Finds pixels whose samples show different surfaces, and copies what all others show into the targets that shading reads.
// At an edge these hold the background: its surfaces are shaded apart (collect_edges.comp, shade_edges.comp).
#version 460
#extension GL_GOOGLE_include_directive : require
#include "frame_schema.glsl"

layout(constant_id = 0) const uint samples = 4u;
layout(local_size_x = TILE_SIZE_PX, local_size_y = TILE_SIZE_PX) in;
layout(binding = 2, rgba32ui) uniform writeonly uimage2D surface_image;
layout(binding = 3, r32f) uniform writeonly image2D depth_image;
layout(binding = 4, rgba32f) uniform writeonly image2D radiance_image;
layout(binding = 5, scalar) writeonly buffer EdgeTiles { EdgeTile edge_tiles[]; };
layout(binding = 6, scalar) writeonly buffer EdgeTileNumbers { uint edge_tile_numbers[]; };
layout(binding = 7, scalar) buffer Counters { EdgeCounters counters; };
layout(push_constant, scalar) uniform Push { EdgeConstants edges; };

#define same_depth edges.same_depth
#include "shading/samples.glsl"

const uint THREADS = TILE_SIZE_PX * TILE_SIZE_PX;
shared uint words[THREADS / 32u];

bool is_edge(ivec2 pixel, Sample first) {
  bool edge = false;
  for (uint i = 1u; i < samples; ++i) edge = edge || !same_surface(first, sample_at(pixel, i));
  return edge;
}

void copy_surface(ivec2 pixel, Sample s, bool edge) {
  imageStore(surface_image, pixel, s.bits);
  imageStore(depth_image, pixel, vec4(edge ? 0.0 : s.depth));
  imageStore(radiance_image, pixel, vec4(s.radiance.rgb, edge && is_unlit(s.radiance.a) ? alpha_of_occlusion(1.0) : s.radiance.a));
}

void main() {
  uint thread = gl_LocalInvocationIndex;
  if (thread < THREADS / 32u) words[thread] = 0u;
  barrier();
  ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  if (all(lessThan(pixel, imageSize(radiance_image)))) {
    Sample first = sample_at(pixel, 0u);
    bool edge = is_edge(pixel, first);
    copy_surface(pixel, first, edge);
    if (edge) atomicOr(words[thread / 32u], 1u << thread % 32u);
  }
  barrier();
  uint tile = gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x;
  if (thread < THREADS / 32u) edge_tiles[tile].pixel_bits[thread] = words[thread];
  if (thread != 0u) return;
  edge_tiles[tile].nearest = 0u;
  edge_tiles[tile].farthest = 0xFFFFFFFFu;
  uint pixels = 0u;
  for (uint i = 0u; i < THREADS / 32u; ++i) pixels += bitCount(words[i]);
  if (pixels == 0u) return;
  atomicAdd(counters.pixels, pixels);
  uint place = atomicAdd(counters.tiles, 1u);
  atomicMax(counters.tiles_x, min(place + 1u, EDGE_GROUPS_X));
  atomicMax(counters.tiles_y, place / EDGE_GROUPS_X + 1u);
  edge_tile_numbers[place] = tile;
}
