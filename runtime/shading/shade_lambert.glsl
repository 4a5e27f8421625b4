// SPDX-License-Identifier: Apache-2.0
// Shade answer `lambert`: diffuse reflection only, of metals too.
#include "shading/brdf.glsl"

Reflector reflector_lambert(Surface s, vec3 to_eye) {
  Reflector r = glossy_reflector(s, to_eye);
  r.diffuse = s.base_color / PI;
  return r;
}
vec3 reflected_lambert(Reflector r, vec3 to_light, float n_dot_l) { return r.diffuse; }
