// SPDX-License-Identifier: Apache-2.0
// Lists the surfaces of a tile's edge pixels. A work group takes a tile that has some, in turns of as many pixels as it has
// threads. The order of a tile's surfaces is fixed; where a turn's surfaces stand in the list is not.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "frame_schema.glsl"

layout(constant_id = 0) const uint samples = 4u;
layout(local_size_x = EDGE_GROUP_SIZE) in;
layout(binding = 2) uniform sampler2DMS depth_samples;
layout(binding = 3, scalar) buffer EdgeTiles { EdgeTile edge_tiles[]; };
layout(binding = 4, scalar) readonly buffer EdgeTileNumbers { uint edge_tile_numbers[]; };
layout(binding = 5, scalar) buffer Counters { EdgeCounters counters; };
layout(binding = 6, scalar) writeonly buffer EdgeSurfaces { EdgeSurface edge_surfaces[]; };
layout(binding = 7, scalar) writeonly buffer EdgeGroups { EdgeGroup edge_groups[]; };
layout(push_constant, scalar) uniform Push { EdgeConstants edges; };

#define same_depth edges.same_depth
#include "shading/edges.glsl"
#include "shading/samples.glsl"

const uint WORDS = TILE_SIZE_PX * TILE_SIZE_PX / 32u;
shared uint counts[EDGE_GROUP_SIZE];
shared uint first_surface, first_group;
shared uint nearest_bits, farthest_bits;  // depths as integers, which order alike

// The surfaces of a pixel. Where nothing is seen there is no surface.
struct Surfaces {
  uvec2 packed_samples;  // a byte for each surface, with a bit for each sample
  uint unlit;            // a bit for each surface
  uint count;
};

void add_surface(inout Surfaces found, uint samples_of, bool unlit) {
  uint shifted = samples_of << 8u * (found.count & 3u);
  found.packed_samples |= found.count < 4u ? uvec2(shifted, 0u) : uvec2(0u, shifted);
  found.unlit |= (unlit ? 1u : 0u) << found.count;
  ++found.count;
}

uint samples_of(Surfaces found, uint i) {
  uint word = i < 4u ? found.packed_samples.x : found.packed_samples.y;
  return word >> 8u * (i & 3u) & 0xFFu;
}

// The number in its tile of the edge pixel `number`.
uint pixel_of(uint tile, uint number) {
  uint word = 0u;
  uint bits = edge_tiles[tile].pixel_bits[0];
  while (word + 1u < WORDS && number >= bitCount(bits)) {
    number -= bitCount(bits);
    bits = edge_tiles[tile].pixel_bits[++word];
  }
  for (; number > 0u; --number) bits &= bits - 1u;
  return 32u * word + findLSB(bits);
}

Surfaces surfaces_of(ivec2 pixel) {
  Surfaces found = Surfaces(uvec2(0u), 0u, 0u);
  uint left = (1u << samples) - 1u;
  for (uint i = 0u; i < samples; ++i) {
    Sample own = sample_at(pixel, i);
    bool is_new = (left >> i & 1u) != 0u;
    uint alike = 1u << i;
    for (uint j = i + 1u; j < samples; ++j)
      if ((left >> j & 1u) != 0u && same_surface(own, sample_at(pixel, j))) alike |= 1u << j;
    if (is_new && own.depth != 0.0) add_surface(found, alike, is_unlit(own.radiance.a));
    if (is_new) left &= ~alike;
  }
  return found;
}

void list_surfaces(ivec2 pixel, uint number, Surfaces found, uint at) {
  for (uint i = 0u; i < found.count; ++i) {
    int one = findLSB(samples_of(found, i));
    uint flags = (i == 0u ? EDGE_FIRST : 0u) | ((found.unlit >> i & 1u) != 0u ? EDGE_UNLIT : 0u);
    edge_surfaces[at + i].place = number | samples_of(found, i) << EDGE_SAMPLES_AT | flags;
    edge_surfaces[at + i].radiance = texelFetch(radiance_samples, pixel, one).rgb;
    uint depth = floatBitsToUint(texelFetch(depth_samples, pixel, one).r);
    if (depth == 0u) continue;
    atomicMax(nearest_bits, depth);
    atomicMin(farthest_bits, depth);
  }
}

// Room for the surfaces of a turn.
void take_room(uint tile, uint total) {
  uint groups = (total + EDGE_GROUP_SIZE - 1u) / EDGE_GROUP_SIZE;
  first_surface = atomicAdd(counters.surfaces, total);
  first_group = atomicAdd(counters.groups, groups);
  uint end = first_group + groups;
  atomicMax(counters.groups_x, min(end, EDGE_GROUPS_X));
  atomicMax(counters.groups_y, (end + EDGE_GROUPS_X - 1u) / EDGE_GROUPS_X);
  for (uint i = 0u; i < groups; ++i)
    edge_groups[first_group + i] = EdgeGroup(tile, first_surface + i * EDGE_GROUP_SIZE, min(total - i * EDGE_GROUP_SIZE, EDGE_GROUP_SIZE));
}

void main() {
  uint thread = gl_LocalInvocationIndex;
  if (group_number() >= counters.tiles) return;
  uint tile = edge_tile_numbers[group_number()];
  uint pixels = 0u;
  for (uint i = 0u; i < WORDS; ++i) pixels += bitCount(edge_tiles[tile].pixel_bits[i]);
  if (thread == 0u) {
    nearest_bits = 0u;
    farthest_bits = 0xFFFFFFFFu;
  }
  uint turn = 0u;
  do {
    bool has_one = turn + thread < pixels;
    uint number = has_one ? pixel_of(tile, turn + thread) : 0u;
    ivec2 pixel = ivec2(edge_pixel(number, tile_at(tile, edges.tiles_x)));
    Surfaces found = surfaces_of(pixel);
    if (!has_one) found.count = 0u;
    counts[thread] = found.count;
    barrier();
    uint before = 0u, total = 0u;
    for (uint i = 0u; i < EDGE_GROUP_SIZE; ++i) {
      before += i < thread ? counts[i] : 0u;
      total += counts[i];
    }
    if (thread == 0u && total > 0u) take_room(tile, total);
    barrier();
    list_surfaces(pixel, number, found, first_surface + before);
    turn += EDGE_GROUP_SIZE;
  } while (turn < pixels);
  barrier();
  if (thread != 0u) return;
  edge_tiles[tile].nearest = nearest_bits;
  edge_tiles[tile].farthest = farthest_bits;
}
