// SPDX-License-Identifier: Apache-2.0
// The filter stage: how much of a map's area light reaches p, 0 to 1. Expects `filter_answer` and what shadow_lookup.glsl
// and pcss.glsl expect in scope.
#include "shadows/filter/hard.glsl"
#include "shadows/filter/pcss.glsl"

// For all threads of a subgroup that have something to shade, at once.
float visibility(ShadowMap map, Receiver r) {
  if (filter_answer == FILTER_PCF) return pcf_visibility(map, r);
  if (filter_answer == FILTER_PCSS) return pcss_visibility(map, r);
  return hard_visibility(map, r.p, r.n);
}
