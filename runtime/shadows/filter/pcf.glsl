// SPDX-License-Identifier: Apache-2.0
// Filter answer `pcf`: percentage closer filtering (Reeves et al. 1987) as LightCluster §3.2.2 uses it, over a disc whose
// radius follows the area light that stands for a cluster. The disc lies in the receiver's plane, so that a flat receiver
// never shadows itself however wide the disc is.
#include "shadows/filter/shadow_lookup.glsl"

// Eight darts in the unit disc, at least 0.62 apart, mean squared radius 0.51 (0.5 is an even disc).
const vec2 POISSON_DISC[POISSON_TAPS] =
    vec2[](vec2(0.403, -0.453), vec2(-0.282, -0.503), vec2(0.683, 0.499), vec2(-0.907, -0.361), vec2(-0.224, 0.713),
           vec2(-0.466, 0.094), vec2(0.164, 0.134), vec2(0.941, -0.119));

const float SMOOTHING_TEXELS = 1.5;  // least radius: hides the staircase of a single light's map

// Jimenez 2014, Next Generation Post Processing in Call of Duty: gradient noise, 0 to 1.
float gradient_noise(vec2 pixel) { return fract(52.9829189 * fract(dot(pixel, vec2(0.06711056, 0.00583715)))); }

// Two axes that span the plane across n, turned by the pixel's own angle.
mat2x3 receiver_axes(vec3 n, vec2 pixel) {
  vec3 t = normalize(abs(n.y) < 0.9 ? cross(n, vec3(0.0, 1.0, 0.0)) : cross(n, vec3(1.0, 0.0, 0.0)));
  vec3 b = cross(n, t);
  float angle = 6.2831853 * gradient_noise(pixel);
  return mat2x3(cos(angle) * t + sin(angle) * b, cos(angle) * b - sin(angle) * t);
}

// A disc light of radius R casts a penumbra of radius R * (distance to receiver / distance to blocker - 1). PCF knows no
// blocker. 0.08 is what came nearest to the reference on the example scenes (README.md of runtime/shadows); it fits a disc
// of half d_min, where the members lie on average, and a blocker six sevenths of the way along.
const float PENUMBRA_PER_D_MIN = 0.08;

float pcf_radius(ShadowMap map, vec3 p) {
  return max(SMOOTHING_TEXELS * texel_size(map, p), min(PENUMBRA_PER_D_MIN * map.filter_radius_m, 0.5 * distance(p, map.center_ws)));
}

// One tap, at q in the plane of receiver p. It is moved off the surface by itself: it may fall on another face, at another
// slope, than p does. And it is compared no farther away than p: what is farther cannot shadow p, though in a concave
// corner it may stand before q.
float cube_tap(ShadowMap map, vec3 p, vec3 q, vec3 n, float texels) {
  vec3 d = offset_from_surface(map, q, n, texels) - map.center_ws;
  return cube_lit(map, map.center_ws + d * min(1.0, distance(p, map.center_ws) * inversesqrt(dot(d, d))));
}

float pcf_visibility(ShadowMap map, vec3 p, vec3 n, vec2 pixel) {
  const float texels = 1.5;  // bilinear comparison reads texels whose centres are up to a diagonal away
  mat2x3 axes = receiver_axes(n, pixel);
  float lit = 0.0;
  if (map.is_directional != 0u) {
    ShadowView cascade = views[cascade_at(map, p)];
    p += n * (texels * cascade.texel_m);
    axes *= SMOOTHING_TEXELS * cascade.texel_m;
    for (uint i = 0u; i < POISSON_TAPS; ++i) lit += cascade_lit(cascade, p + axes * POISSON_DISC[i]);
  } else {
    axes *= pcf_radius(map, p);
    for (uint i = 0u; i < POISSON_TAPS; ++i) lit += cube_tap(map, p, p + axes * POISSON_DISC[i], n, texels);
  }
  return lit / float(POISSON_TAPS);
}
