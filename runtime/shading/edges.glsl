// SPDX-License-Identifier: Apache-2.0
// Pixels whose samples show several surfaces. What a pixel shows is the mean of its samples.
#ifndef CHANDELIER_EDGES_GLSL
#define CHANDELIER_EDGES_GLSL

// EdgeSurface::place: the pixel's number in its tile, then a bit for each sample, then two flags.
const uint EDGE_SAMPLES_AT = 8u;
const uint EDGE_FIRST = 1u << 16;  // of its pixel
const uint EDGE_UNLIT = 1u << 17;

uint edge_samples(uint place) { return place >> EDGE_SAMPLES_AT & 0xFFu; }

uvec2 tile_at(uint tile, uint tiles_x) { return uvec2(tile % tiles_x, tile / tiles_x); }

uvec2 edge_pixel(uint place, uvec2 tile) {
  return tile * TILE_SIZE_PX + uvec2(place % TILE_SIZE_PX, place / TILE_SIZE_PX % TILE_SIZE_PX);
}

// Vulkan's standard sample locations, in sixteenths of a pixel: x, y of 2, 4 and 8 samples.
const uvec2 SAMPLE_PLACES[14] =
    uvec2[](uvec2(12, 12), uvec2(4, 4), uvec2(6, 2), uvec2(14, 6), uvec2(2, 10), uvec2(10, 14), uvec2(9, 5), uvec2(7, 11),
            uvec2(13, 9), uvec2(5, 3), uvec2(3, 13), uvec2(1, 7), uvec2(11, 15), uvec2(15, 1));
vec2 sample_place(uint samples, uint i) { return vec2(SAMPLE_PLACES[samples - 2u + i]) / 16.0; }

// This work group's number in a dispatch whose size EdgeCounters say.
uint group_number() { return gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x; }

#endif
