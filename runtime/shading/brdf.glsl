// SPDX-License-Identifier: Apache-2.0
// glTF 2.0 appendix B: Lambert under a GGX microfacet layer, and the falloff of KHR_lights_punctual. Masking-shadowing is
// height-correlated (Heitz 2014), where the appendix prints the separable form.
#ifndef CHANDELIER_BRDF_GLSL
#define CHANDELIER_BRDF_GLSL
#include "shading/surface.glsl"

const float PI = 3.14159265359;

vec3 lambert(Surface s) { return s.base_color / PI; }

vec3 ggx(Surface s, vec3 to_eye, vec3 to_light, float n_dot_l) {
  vec3 h = normalize(to_eye + to_light);
  float n_dot_v = max(dot(s.normal, to_eye), 1e-4);
  float n_dot_h = clamp(dot(s.normal, h), 0.0, 1.0);
  float v_dot_h = clamp(dot(to_eye, h), 0.0, 1.0);
  float a = max(s.roughness * s.roughness, 0.002);  // below, a highlight is smaller than any pixel
  float a2 = a * a;
  float d_root = (n_dot_h * a2 - n_dot_h) * n_dot_h + 1.0;
  float d = a2 / (PI * d_root * d_root);
  float smith = n_dot_l * sqrt((n_dot_v - n_dot_v * a2) * n_dot_v + a2) + n_dot_v * sqrt((n_dot_l - n_dot_l * a2) * n_dot_l + a2);
  float v = 0.5 / max(smith, 1e-6);
  vec3 f0 = mix(vec3(0.04), s.base_color, s.metallic);
  vec3 f = f0 + (1.0 - f0) * pow(1.0 - v_dot_h, 5.0);
  vec3 diffuse = s.base_color * (1.0 - s.metallic) / PI;
  return (1.0 - f) * diffuse + f * (d * v);
}

// Illuminance per candela at a distance, 1/m².
float distance_falloff(float distance_m, float range_m) {
  float ratio = distance_m / range_m;
  float window = clamp(1.0 - ratio * ratio * ratio * ratio, 0.0, 1.0);
  return window / max(distance_m * distance_m, 1e-4);
}

#endif
