// SPDX-License-Identifier: Apache-2.0
// Unit vectors on an unfolded octahedron.
// Cigolle et al. 2014, A Survey of Efficient Representations for Independent Unit Vectors.
#ifndef CHANDELIER_OCTAHEDRAL_GLSL
#define CHANDELIER_OCTAHEDRAL_GLSL

vec2 octahedral(vec3 n) {
  vec2 p = n.xy / (abs(n.x) + abs(n.y) + abs(n.z));
  vec2 folded = (1.0 - abs(p.yx)) * mix(vec2(-1.0), vec2(1.0), greaterThanEqual(p, vec2(0.0)));
  return n.z >= 0.0 ? p : folded;
}

vec3 from_octahedral(vec2 p) {
  vec3 n = vec3(p, 1.0 - abs(p.x) - abs(p.y));
  vec2 folded = (1.0 - abs(p.yx)) * mix(vec2(-1.0), vec2(1.0), greaterThanEqual(p, vec2(0.0)));
  if (n.z < 0.0) n.xy = folded;
  return normalize(n);
}

// VertexAttributes::normal_ls of the pack.
vec3 decode_normal(uint bits) {
  return from_octahedral(unpackSnorm2x16(bits));
}

// VertexAttributes::tangent_ls of the pack; w is the bitangent's sign.
vec4 decode_tangent(uint bits) {
  float y = max(float(bitfieldExtract(int(bits), 16, 15)) / 16383.0, -1.0);
  return vec4(from_octahedral(vec2(unpackSnorm2x16(bits).x, y)), bits >> 31 != 0u ? -1.0 : 1.0);
}

#endif
