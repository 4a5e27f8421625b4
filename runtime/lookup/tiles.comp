// SPDX-License-Identifier: Apache-2.0
// Lookup answer `tiles`: which lights reach a tile of 16 x 16 pixels (Lauritzen 2010, Deferred Rendering for Current and Future
// Rendering Pipelines). A tile is the piece of the view between its nearest and its farthest surface. One bit a light,
// in the lights' order. Conservative: a light that reaches any of the tile's surfaces has its bit set.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "frame_schema.glsl"
#include "pack_schema.glsl"
#include "shading/eye_position.glsl"

layout(constant_id = 0) const uint has_edges = 0u;  // 1: edge pixels are background in depth_image, and their depths here
layout(local_size_x = TILE_SIZE_PX, local_size_y = TILE_SIZE_PX) in;
layout(binding = 0, scalar) readonly buffer View { ViewConstants view; };
layout(binding = 1, scalar) readonly buffer Lights { FrameLight lights[]; };
layout(binding = 2) uniform sampler2D depth_image;
layout(binding = 3, scalar) writeonly buffer TileWords { TileWord tile_words[]; };
layout(binding = 4, scalar) readonly buffer EdgeTiles { EdgeTile edge_tiles[]; };
layout(push_constant, scalar) uniform Push { TileConstants tiles; };

const uint THREADS = TILE_SIZE_PX * TILE_SIZE_PX;
// Rounding of positions that shading rebuilds from depth, relative to their distance.
const float ROUNDING = 1e-5;

shared uint nearest_bits, farthest_bits;  // depths as integers, which order alike: reversed, above 0
shared uint words[THREADS / 32u];

struct Tile {
  vec3 sides[4];    // inward normals of planes through the eye
  float nearest_m;  // along the view
  float farthest_m;
};

// Depth 0 is infinitely far: what is left of a position there is its direction.
vec3 corner_way(vec2 pixel) {
  return normalize(eye_point(view, pixel, 0.0).xyz);
}

Tile make_tile(float nearest, float farthest) {
  vec2 low = vec2(gl_WorkGroupID.xy * TILE_SIZE_PX);
  vec2 high = low + float(TILE_SIZE_PX);
  vec3 ways[4] = vec3[](corner_way(low), corner_way(vec2(high.x, low.y)), corner_way(high), corner_way(vec2(low.x, high.y)));
  Tile tile;
  for (uint i = 0u; i < 4u; ++i) tile.sides[i] = normalize(cross(ways[i], ways[(i + 1u) % 4u]));
  tile.nearest_m = view.near_m / nearest;
  tile.farthest_m = view.near_m / farthest;
  return tile;
}

bool reaches(FrameLight light, Tile tile) {
  if (light.type == LIGHT_TYPE_DIRECTIONAL) return true;
  vec3 d = light.position_ws - view.eye_ws;
  float radius = light.range_m + ROUNDING * (light.range_m + tile.farthest_m);
  float along = dot(d, view.forward_ws);
  bool inside = along + radius >= tile.nearest_m && along - radius <= tile.farthest_m;
  for (uint i = 0u; i < 4u; ++i) inside = inside && dot(d, tile.sides[i]) >= -radius;
  return inside;
}

void main() {
  uint thread = gl_LocalInvocationIndex;
  uint tile_number = gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x;
  if (thread == 0u) {
    nearest_bits = has_edges != 0u ? edge_tiles[tile_number].nearest : 0u;
    farthest_bits = has_edges != 0u ? edge_tiles[tile_number].farthest : 0xFFFFFFFFu;
  }
  barrier();
  ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  bool in_picture = all(lessThan(vec2(pixel), view.size_px));
  float depth = in_picture ? texelFetch(depth_image, pixel, 0).r : 0.0;
  if (depth > 0.0) {
    atomicMax(nearest_bits, floatBitsToUint(depth));
    atomicMin(farthest_bits, floatBitsToUint(depth));
  }
  barrier();
  bool seen = nearest_bits != 0u;
  Tile tile = make_tile(uintBitsToFloat(nearest_bits), uintBitsToFloat(farthest_bits));

  uint first_word = tile_number * tiles.words_per_tile;
  for (uint first = 0u; first < tiles.light_count; first += THREADS) {
    if (thread < THREADS / 32u) words[thread] = 0u;
    barrier();
    uint number = first + thread;
    if (seen && number < tiles.light_count && reaches(lights[number], tile)) atomicOr(words[thread / 32u], 1u << thread % 32u);
    barrier();
    uint word = first / 32u + thread;
    if (thread < THREADS / 32u && word < tiles.words_per_tile) tile_words[first_word + word].bits = words[thread];
    barrier();
  }
}
