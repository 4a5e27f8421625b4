// SPDX-License-Identifier: Apache-2.0
// Filter answer `pcss`: percentage closer soft shadows (Fernando 2005) of the disc light that stands for a cluster
// (LightCluster §3.2.2), which lies parallel to the receiver. Expects in scope, beside what shadow_lookup.glsl does, the
// same depths without comparison: `samplerCubeArray cube_depths` and `sampler2DArray layer_depths`.
#include "shadows/filter/pcf.glsl"

struct Blockers {
  uint count;
  float mean;  // the mean of what the function that found them says
};

// A blocker: the part of the way from the centre to the plane at which it stands.
Blockers cube_blockers(CubeDisc disc, float search_m) {
  uint count = 0u;
  float sum = 0.0;
  for (uint i = 0u; i < POISSON_TAPS; ++i) {
    Tap tap = cube_tap(disc, search_m * POISSON_DISC[i]);
    float blocker = textureLod(cube_depths, vec4(tap.at, disc.cube), 0.0).r;
    bool blocks = blocker > tap.compared;
    count += blocks ? 1u : 0u;
    sum += blocks ? tap.depth / blocker : 0.0;
  }
  return Blockers(count, sum / float(max(count, 1u)));
}

// A blocker: its distance from the plane along the light's way, of the cascade's whole depth.
Blockers cascade_blockers(CascadeDisc disc, float search_m) {
  uint count = 0u;
  float sum = 0.0;
  for (uint i = 0u; i < POISSON_TAPS; ++i) {
    Tap tap = cascade_tap(disc, search_m * POISSON_DISC[i]);
    float blocker = textureLod(layer_depths, tap.at, 0.0).r;
    bool blocks = blocker > tap.compared;
    count += blocks ? 1u : 0u;
    sum += blocks ? blocker - tap.depth : 0.0;
  }
  return Blockers(count, sum / float(max(count, 1u)));
}

// The light's edge as a blocker at the part t of the way casts it on the plane lies R * (1 - t) / t from the centre's
// (similar triangles). The search disc is where blockers half way cast it; wider penumbrae are cut off there. Where all
// taps of the search are blocked, so are those of the narrower disc within, but for what lies between the taps.
float cube_pcss(ShadowMap map, vec3 p, vec3 n, mat2x3 axes) {
  float smoothing_m = SMOOTHING_TEXELS * texel_size(map, p);
  float search_m = max(smoothing_m, min(map.filter_radius_m, 0.5 * distance(p, map.center_ws)));
  CubeDisc disc = cube_disc(map, p, n, axes, search_m);
  if (search_m == smoothing_m) return cube_pcf(disc, smoothing_m);
  Blockers found = cube_blockers(disc, search_m);
  if (found.count == 0u) return 1.0;
  if (found.count == POISSON_TAPS) return 0.0;
  return cube_pcf(disc, clamp(map.filter_radius_m * (1.0 - found.mean) / found.mean, smoothing_m, search_m));
}

// A directional cluster's light stands at z_far. The search disc is what it casts from the cascade's near plane.
float cascade_pcss(ShadowView cascade, float light_radius_m, vec3 p, vec3 n, mat2x3 axes) {
  float smoothing_m = SMOOTHING_TEXELS * cascade.texel_m;
  CascadeDisc disc = cascade_disc(cascade, p, n, axes);
  vec3 depth_per_m = vec3(cascade.clip_from_world[0].z, cascade.clip_from_world[1].z, cascade.clip_from_world[2].z);
  float spread_m = light_radius_m / (view.z_far_m * length(depth_per_m));  // over the whole depth
  float search_m = max(smoothing_m, spread_m * (1.0 - disc.receiver.z));
  if (search_m == smoothing_m) return cascade_pcf(disc, smoothing_m);
  Blockers found = cascade_blockers(disc, search_m);
  if (found.count == 0u) return 1.0;
  if (found.count == POISSON_TAPS) return 0.0;
  return cascade_pcf(disc, clamp(spread_m * found.mean, smoothing_m, search_m));
}

float pcss_visibility(ShadowMap map, vec3 p, vec3 n, mat2x3 axes) {
  if (map.is_directional != 0u) return cascade_pcss(views[cascade_at(map, p)], map.filter_radius_m, p, n, axes);
  return cube_pcss(map, p, n, axes);
}
