// SPDX-License-Identifier: Apache-2.0
// Placing a vertex of a mesh in the world.
#ifndef CHANDELIER_INSTANCE_GLSL
#define CHANDELIER_INSTANCE_GLSL

// As seen from a point of the world, along the world's axes. Where both are far from the world's origin, what is taken off
// first are large numbers that are nearly equal: nothing is rounded.
vec3 position_from(vec3 origin_ws, vec4 rows[3], vec3 p) {
  return vec3(dot(rows[0].xyz, p) + (rows[0].w - origin_ws.x), dot(rows[1].xyz, p) + (rows[1].w - origin_ws.y),
              dot(rows[2].xyz, p) + (rows[2].w - origin_ws.z));
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
