// SPDX-License-Identifier: Apache-2.0
// Shade answer `ggx`: glTF's metallic-roughness model.
#include "shading/brdf.glsl"

Reflector reflector_ggx(Surface s, vec3 to_eye) { return glossy_reflector(s, to_eye); }
vec3 reflected_ggx(Reflector r, vec3 to_light, float n_dot_l) { return ggx(r, to_light, n_dot_l); }
