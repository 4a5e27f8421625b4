// SPDX-License-Identifier: Apache-2.0
// glTF 2.0 appendix B: Lambert under a GGX microfacet layer, and the falloff of KHR_lights_punctual. Masking-shadowing is
// height-correlated (Heitz 2014), where the appendix prints the separable form.
#ifndef CHANDELIER_BRDF_GLSL
#define CHANDELIER_BRDF_GLSL
#include "shading/surface.glsl"

const float PI = 3.14159265359;

// What a surface does with light from any direction, as one camera sees it: made once for all its lights.
struct Reflector {
  vec3 normal;
  vec3 to_eye;
  vec3 diffuse;
  vec3 f0;
  float n_dot_v;  // at least 1e-4
  float a2;       // roughness to the fourth
  float smith_v;  // the eye's half of masking-shadowing
};

Reflector glossy_reflector(Surface s, vec3 to_eye) {
  float a = max(s.roughness * s.roughness, 0.002);  // below, a highlight is smaller than any pixel
  float a2 = a * a;
  float n_dot_v = max(dot(s.normal, to_eye), 1e-4);
  return Reflector(s.normal, to_eye, s.base_color * (1.0 - s.metallic) / PI, mix(vec3(0.04), s.base_color, s.metallic), n_dot_v,
                   a2, sqrt((n_dot_v - n_dot_v * a2) * n_dot_v + a2));
}

vec3 ggx(Reflector r, vec3 to_light, float n_dot_l) {
  vec3 h = normalize(r.to_eye + to_light);
  float n_dot_h = clamp(dot(r.normal, h), 0.0, 1.0);
  float v_dot_h = clamp(dot(r.to_eye, h), 0.0, 1.0);
  float d_root = (n_dot_h * r.a2 - n_dot_h) * n_dot_h + 1.0;
  float smith = n_dot_l * r.smith_v + r.n_dot_v * sqrt((n_dot_l - n_dot_l * r.a2) * n_dot_l + r.a2);
  float specular = 0.5 * r.a2 / (PI * d_root * d_root * max(smith, 1e-6));
  float away = 1.0 - v_dot_h;
  float away2 = away * away;
  vec3 f = r.f0 + (1.0 - r.f0) * (away2 * away2 * away);
  return (1.0 - f) * r.diffuse + f * specular;
}

// Illuminance per candela at a distance, 1/m². Takes squares.
float distance_falloff(float distance2, float range2) {
  float ratio2 = distance2 / range2;
  return max(1.0 - ratio2 * ratio2, 0.0) / max(distance2, 1e-4);
}

#endif
