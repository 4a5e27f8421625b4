// SPDX-License-Identifier: Apache-2.0
// What the pixels of a block, four by two whose threads follow each other (shading/strips.glsl), tell each other: each reads
// few texels of a shadow map, and each reads others. Each function is for all threads of a subgroup that have something to shade, at once.
#ifndef CHANDELIER_BLOCK_GLSL
#define CHANDELIER_BLOCK_GLSL

const uint BLOCK_PIXELS = 8u;

// This thread's place in its block.
uint block_place() { return gl_SubgroupInvocationID % BLOCK_PIXELS; }

// Which of the block's other pixels lie on the plane through p across n, or nearly, so that a flat or gently bent surface
// goes on there: bit i stands for the thread whose place differs in the bits of i.
uint block_mates(vec3 p, vec3 n) {
  const float most_slope = 0.1, least_cosine = 0.9;
  uvec4 shading = subgroupBallot(true);
  uint mates = 0u;
  for (uint i = 1u; i < BLOCK_PIXELS; ++i) {
    vec3 away = subgroupShuffleXor(p, i) - p;
    vec3 normal = subgroupShuffleXor(n, i);
    bool goes_on = abs(dot(n, away)) <= most_slope * length(away) && dot(n, normal) >= least_cosine;
    bool is_there = gl_SubgroupSize >= BLOCK_PIXELS && subgroupBallotBitExtract(shading, gl_SubgroupInvocationID ^ i);
    if (goes_on && is_there) mates |= 1u << i;
  }
  return mates;
}

#endif
