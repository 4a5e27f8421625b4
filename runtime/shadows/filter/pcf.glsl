// SPDX-License-Identifier: Apache-2.0
// Filter answer `pcf`: percentage closer filtering (Reeves et al. 1987) as LightCluster §3.2.2 uses it, over a disc whose
// radius follows the area light that stands for a cluster.
#ifndef CHANDELIER_PCF_GLSL
#define CHANDELIER_PCF_GLSL
#include "shadows/filter/receiver_disc.glsl"

// A disc light of radius R casts a penumbra of radius R * (distance to receiver / distance to blocker - 1). PCF knows no
// blocker: it takes one that stands four fifths of the way along, which came nearest to the reference on the example scenes
// (README.md of runtime/shadows).
const float PENUMBRA_PER_RADIUS = 0.27;

float pcf_radius(ShadowMap map, vec3 p) {
  return max(SMOOTHING_TEXELS * texel_size(map, p), min(PENUMBRA_PER_RADIUS * map.filter_radius_m, 0.5 * distance(p, map.center_ws)));
}

// The part of the taps that is lit.
float cube_pcf(CubeDisc disc, float radius_m) {
  float lit = 0.0;
  for (uint i = 0u; i < POISSON_TAPS; ++i) {
    Tap tap = cube_tap(disc, radius_m * POISSON_DISC[i]);
    lit += texture(cubes, vec4(tap.at, disc.cube), tap.compared);
  }
  return lit / float(POISSON_TAPS);
}

float cascade_pcf(CascadeDisc disc, float radius_m) {
  float lit = 0.0;
  for (uint i = 0u; i < POISSON_TAPS; ++i) {
    Tap tap = cascade_tap(disc, radius_m * POISSON_DISC[i]);
    lit += texture(layers, vec4(tap.at, tap.compared));
  }
  return lit / float(POISSON_TAPS);
}

float pcf_visibility(ShadowMap map, vec3 p, vec3 n, mat2x3 axes) {
  if (map.is_directional != 0u) {
    ShadowView cascade = views[cascade_at(map, p)];
    float cascade_radius_m = max(SMOOTHING_TEXELS * cascade.texel_m, PENUMBRA_PER_RADIUS * map.filter_radius_m);
    return cascade_pcf(cascade_disc(cascade, p, n, axes), cascade_radius_m);
  }
  float radius_m = pcf_radius(map, p);
  return cube_pcf(cube_disc(map, p, n, axes, radius_m), radius_m);
}

#endif
