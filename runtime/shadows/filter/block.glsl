// SPDX-License-Identifier: Apache-2.0
// What the pixels of a block, four by two whose threads follow each other (shading/strips.glsl), tell each other: each
// reads a few texels of a shadow map, and each reads others. To be called by all threads of a subgroup that shade, at once. Who
// asks others takes a ballot first: only those that are there just then have an answer.
#ifndef CHANDELIER_BLOCK_GLSL
#define CHANDELIER_BLOCK_GLSL

const uint BLOCK_PIXELS = 8u;

// This pixel's number in its block, from 0. That of another is block_place() ^ i, for i from 1 to 7; subgroupShuffleXor(…, i)
// asks it.
uint block_place() { return gl_SubgroupInvocationID % BLOCK_PIXELS; }

// For which pixels of the block something holds: a bit for each.
uint block_ballot(bool holds) {
  uint first = gl_SubgroupInvocationID - block_place();
  return subgroupBallot(holds)[first / 32u] >> first % 32u & 0xFFu;
}

bool has_bit(uint bits, uint i) { return (bits >> i & 1u) != 0u; }

// The other pixels of the block on whose surface the plane through p across n goes on, or nearly: flat or gently bent.
uint block_mates(vec3 p, vec3 n) {
  const float most_slope = 0.1, least_cosine = 0.9;
  uint shading = block_ballot(true);
  uint mates = 0u;
  for (uint i = 1u; i < BLOCK_PIXELS; ++i) {
    uint other = block_place() ^ i;
    vec3 way = subgroupShuffleXor(p, i) - p;
    vec3 its_normal = subgroupShuffleXor(n, i);
    bool goes_on = abs(dot(n, way)) <= most_slope * length(way) && dot(n, its_normal) >= least_cosine;
    if (goes_on && has_bit(shading, other)) mates |= 1u << other;
  }
  return mates;
}

#endif
