// SPDX-License-Identifier: Apache-2.0
// Light from all around, as a function of direction: the same in lights/ambient.cpp, which says what the coefficients are.
#ifndef CHANDELIER_AMBIENT_GLSL
#define CHANDELIER_AMBIENT_GLSL

// Irradiance over pi of a surface with normal n, unit length, in the world.
vec3 ambient_at(vec3 c[9], vec3 n) {
  vec3 first = c[1] * n.y + c[2] * n.z + c[3] * n.x;
  vec3 second = c[4] * (n.x * n.y) + c[5] * (n.y * n.z) + c[6] * (3.0 * n.z * n.z - 1.0) + c[7] * (n.x * n.z) +
                c[8] * (n.x * n.x - n.y * n.y);
  return max(c[0] + first + second, vec3(0.0));
}

#endif
