// SPDX-License-Identifier: Apache-2.0
// What a screen shows of linear radiance: a filmic curve after exposure, then sRGB.
#ifndef CHANDELIER_TONE_MAP_GLSL
#define CHANDELIER_TONE_MAP_GLSL
#include "shading/occlusion.glsl"

// Narkowicz 2015, ACES Filmic Tone Mapping Curve.
vec3 filmic(vec3 x) { return clamp(x * (2.51 * x + 0.03) / (x * (2.43 * x + 0.59) + 0.14), 0.0, 1.0); }

// IEC 61966-2-1
vec3 srgb(vec3 x) { return mix(x * 12.92, 1.055 * pow(x, vec3(1.0 / 2.4)) - 0.055, greaterThan(x, vec3(0.0031308))); }

// What a screen emits, 0 to 1 and linear.
vec3 shown_linear(vec4 radiance, float exposure_ev) {
  vec3 exposed = min(radiance.rgb * exp2(exposure_ev), vec3(1e4));  // white long before
  return is_unlit(radiance.a) ? clamp(radiance.rgb, 0.0, 1.0) : filmic(exposed);
}

#endif
