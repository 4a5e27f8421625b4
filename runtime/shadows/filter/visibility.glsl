// SPDX-License-Identifier: Apache-2.0
// The filter stage: how much of a map's area light reaches p, 0 to 1. Expects `filter_answer` and what shadow_lookup.glsl
// expects in scope.
#include "shadows/filter/hard.glsl"
#include "shadows/filter/pcf.glsl"

const uint FILTER_HARD = 0u, FILTER_PCF = 1u;  // frame/recipe.h

float visibility(ShadowMap map, vec3 p, vec3 n, vec2 pixel) {
  if (filter_answer == FILTER_PCF) return pcf_visibility(map, p, n, pixel);
  return hard_visibility(map, p, n);
}
