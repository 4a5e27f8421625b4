// SPDX-License-Identifier: Apache-2.0
// The order in which work groups cross the picture: down strips of it, left to right within each. Rows as wide as the
// picture would have dropped from the caches what the groups above have read of the shadow maps.
#ifndef CHANDELIER_STRIPS_GLSL
#define CHANDELIER_STRIPS_GLSL

const uint STRIP_GROUPS = 12u;  // 96 pixels: with 4 and with 32 groups half of the gain is lost

// The place of this work group's square of the picture, in squares.
uvec2 square_of_group() {
  uint number = gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x;
  uint left = number / (STRIP_GROUPS * gl_NumWorkGroups.y) * STRIP_GROUPS;
  uint width = min(STRIP_GROUPS, gl_NumWorkGroups.x - left);
  uint within = number - left * gl_NumWorkGroups.y;
  return uvec2(left + within % width, within / width);
}

// Threads that follow each other share a square of 2 by 2 pixels, 4 by 2, 4 by 4 and 8 by 4: the bits of a thread's number
// are one of x and one of y in turns.
uvec2 pixel_of_thread() {
  uvec2 bits = uvec2(gl_LocalInvocationIndex, gl_LocalInvocationIndex >> 1u);
  uvec2 within = (bits & 1u) | (bits >> 1u & 2u) | (bits >> 2u & 4u);
  return square_of_group() * gl_WorkGroupSize.xy + within;
}

uvec2 tile_of_group() { return square_of_group() * gl_WorkGroupSize.xy / TILE_SIZE_PX; }

#endif
