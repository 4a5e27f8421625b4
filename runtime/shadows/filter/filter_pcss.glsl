// SPDX-License-Identifier: Apache-2.0
// Filter answer `pcss`: percentage closer soft shadows (Fernando 2005) of the disc light that stands for a cluster
// (LightCluster §3.2.2), which lies parallel to the receiver. Expects in scope, beside what shadow_lookup.glsl does, the
// same depths without comparison: `samplerCubeArray cube_depths` and `sampler2DArray layer_depths`.
#ifndef CHANDELIER_FILTER_PCSS_GLSL
#define CHANDELIER_FILTER_PCSS_GLSL
#include "shadows/filter/filter_pcf.glsl"

// This pixel's blockers and those of its block's that searched nearly the same disc.
Blockers blockers_of_block(vec3 p, uint mates, Blockers own, float search_m) {
  Blockers found = own;
  mates &= block_ballot(true);
  for (uint i = 1u; i < BLOCK_PIXELS; ++i) {
    vec3 way = subgroupShuffleXor(p, i) - p;
    uint its_count = subgroupShuffleXor(own.count, i);
    float its_sum = subgroupShuffleXor(own.sum, i);
    if (has_bit(mates, block_place() ^ i) && length(way) <= SHARE_RADII * search_m) {
      found.count += its_count;
      found.sum += its_sum;
      found.taps += DISC_TAPS;
    }
  }
  return found;
}

float mean_blocker(Blockers found) { return max(found.sum / float(max(found.count, 1u)), 1e-6); }

// A light without a radius needs no search.
struct Search {
  bool made;
  Blockers blockers;
};

bool all_lit(Search found) { return found.made && found.blockers.count == 0u; }
bool all_dark(Search found) { return found.made && found.blockers.count == found.blockers.taps; }
bool asks_taps(Search found) { return !all_lit(found) && !all_dark(found); }

// No fewer than lit_by_taps() can read where it is the block's other pixels that ask.
uint taps_after(Search found) { return asks_taps(found) ? DISC_TAPS : 4u; }

// `own` is what the taps say; where the search said enough, that counts.
float lit_after(Search found, Receiver r, uint mates, Lit own, float radius_m) {
  float sure = all_lit(found) ? 1.0 : 0.0;
  if (!asks_taps(found)) own = Lit(sure, vec3(0.0));
  float of_block = lit_of_block(r.p, mates, own, radius_m);
  return asks_taps(found) ? of_block : sure;
}

// The light's edge as a blocker at the part t of the way casts it on the plane lies R * (1 - t) / t from the centre's
// (similar triangles). The search disc is where blockers half way cast it; wider penumbrae are cut off there. Where all
// taps of the search are blocked, so are those of the narrower disc within, but for what lies between the taps.
float cube_pcss(ShadowMap map, Receiver r) {
  float smoothing_m = SMOOTHING_TEXELS * texel_size(map, r.p);
  float search_m = max(smoothing_m, min(map.filter_radius_m, 0.5 * length(from_center(map, r.p))));
  CubeDisc disc = cube_disc(map, r.p, r.n, r.axes, search_m);
  uint mates = facing_mates(r, -from_center(map, r.p));
  Search found = Search(search_m > smoothing_m, Blockers(0u, 0.0, 0u));
  if (subgroupAny(found.made)) found.blockers = blockers_of_block(r.p, mates, blockers_of_taps(disc, search_m), search_m);
  if (!subgroupAny(asks_taps(found))) return all_lit(found) ? 1.0 : 0.0;
  float t = mean_blocker(found.blockers);
  float radius_m = found.made ? clamp(map.filter_radius_m * (1.0 - t) / t, smoothing_m, search_m) : smoothing_m;
  return lit_after(found, r, mates, lit_by_taps(disc, r.axes, radius_m, taps_after(found)), radius_m);
}

// A directional cluster's light stands at z_far. The search disc is what it casts from the cascade's near plane.
float cascade_pcss(ShadowMap map, ShadowView cascade, Receiver r) {
  float smoothing_m = SMOOTHING_TEXELS * cascade.texel_m;
  CascadeDisc disc = cascade_disc(map, cascade, r.p, r.n, r.axes);
  float spread_m = map.filter_radius_m / (view.z_far_m * length(depth_per_m(cascade)));  // over the whole depth
  float search_m = max(smoothing_m, spread_m * (1.0 - disc.receiver.z));
  uint mates = facing_mates(r, depth_per_m(cascade));
  Search found = Search(search_m > smoothing_m, Blockers(0u, 0.0, 0u));
  if (subgroupAny(found.made)) found.blockers = blockers_of_block(r.p, mates, blockers_of_taps(disc, search_m), search_m);
  if (!subgroupAny(asks_taps(found))) return all_lit(found) ? 1.0 : 0.0;
  float radius_m = found.made ? clamp(spread_m * mean_blocker(found.blockers), smoothing_m, search_m) : smoothing_m;
  return lit_after(found, r, mates, lit_by_taps(disc, r.axes, radius_m, taps_after(found)), radius_m);
}

float visibility_pcss(ShadowMap map, Receiver r) {
  if (is_projected(map, PROJECTION_CASCADE)) return cascade_pcss(map, views[cascade_at(map, r.p)], r);
  return cube_pcss(map, r);
}

#endif
