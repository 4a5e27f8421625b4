// SPDX-License-Identifier: Apache-2.0
// Placing a vertex of a mesh in the world.
#ifndef CHANDELIER_INSTANCE_GLSL
#define CHANDELIER_INSTANCE_GLSL

vec3 to_world(vec4 rows[3], vec3 p) {
  return vec3(dot(rows[0].xyz, p) + rows[0].w, dot(rows[1].xyz, p) + rows[1].w, dot(rows[2].xyz, p) + rows[2].w);
}

vec3 direction_to_world(vec4 rows[3], vec3 d) {
  return vec3(dot(rows[0].xyz, d), dot(rows[1].xyz, d), dot(rows[2].xyz, d));
}

// The cofactor matrix: the inverse transpose up to a positive factor, mirrored or not.
vec3 normal_to_world(vec4 rows[3], vec3 n) {
  vec3 c0 = cross(rows[1].xyz, rows[2].xyz);
  vec3 c1 = cross(rows[2].xyz, rows[0].xyz);
  vec3 c2 = cross(rows[0].xyz, rows[1].xyz);
  float mirror = dot(rows[0].xyz, c0) < 0.0 ? -1.0 : 1.0;
  return mirror * vec3(dot(c0, n), dot(c1, n), dot(c2, n));
}

#endif
