// SPDX-License-Identifier: Apache-2.0
// Filter answer `pcf`: percentage closer filtering (Reeves et al. 1987) as LightCluster §3.2.2 uses it, over a disc whose
// radius follows the area light that stands for a cluster.
#ifndef CHANDELIER_PCF_GLSL
#define CHANDELIER_PCF_GLSL
#include "shadows/filter/corner.glsl"

// A disc light of radius R casts a penumbra of radius R * (distance to receiver / distance to blocker - 1). PCF knows no
// blocker: it takes one that stands four fifths of the way along, which came nearest to the reference on the example scenes
// (README.md of runtime/shadows).
const float PENUMBRA_PER_RADIUS = 0.27;

// Where a tap lies in the layers: between the middles of its view's outermost texels.
vec3 in_layers(Square square, vec2 uv, float layer) {
  vec2 at = clamp((uv * 0.5 + 0.5) * square.size, 0.5, square.size - 0.5);
  return vec3((square.corner + at) / view.face_size_px, layer);
}

vec3 in_layers(CubeDisc disc, Tap tap) {
  vec3 on_face = to_face(tap.at, tap.at);
  return in_layers(disc.square, on_face.xy / on_face.z, 6.0 * disc.cube + face_of(tap.at));
}

// Does a tap lie beside its cascade, where nothing casts? With whole layers the sampler's border says so.
bool is_beside(Tap tap) { return parts_of_layers && any(greaterThan(abs(tap.at.xy - 0.5), vec2(0.5))); }

// How much of the texels around a tap is no nearer to the light than what it is compared with.
float lit(CubeDisc disc, Tap tap) {
  if (parts_of_layers) return texture(layers, vec4(in_layers(disc, tap), tap.compared));
  return texture(cubes, vec4(tap.at, disc.cube), tap.compared);
}
float lit(CascadeDisc disc, Tap tap) {
  vec3 at = parts_of_layers ? in_layers(disc.square, tap.at.xy * 2.0 - 1.0, tap.at.z) : tap.at;
  float part = texture(layers, vec4(at, tap.compared));
  return is_beside(tap) ? 1.0 : part;
}

// The depth of the texel that a tap falls on.
float depth_at(CubeDisc disc, Tap tap) {
  if (parts_of_layers) return textureLod(layer_depths, in_layers(disc, tap), 0.0).r;
  return textureLod(cube_depths, vec4(tap.at, disc.cube), 0.0).r;
}
float depth_at(CascadeDisc disc, Tap tap) {
  vec3 at = parts_of_layers ? in_layers(disc.square, tap.at.xy * 2.0 - 1.0, tap.at.z) : tap.at;
  float depth = textureLod(layer_depths, at, 0.0).r;
  return is_beside(tap) ? 0.0 : depth;
}

float pcf_radius(ShadowMap map, vec3 p) {
  return max(SMOOTHING_TEXELS * texel_size(map, p), min(PENUMBRA_PER_RADIUS * map.filter_radius_m, 0.5 * length(from_center(map, p))));
}

// Pixels of a block share what they found nearer than this part of the disc's radius, and less up to twice as far.
const float SHARE_RADII = 0.25;

// What a pixel's own taps say.
struct Lit {
  float part;  // of the disc
  vec3 slope;  // by how much more of it is lit a metre further on along the plane
};

struct TapSums {
  float lit;
  vec2 turns;  // each tap's way from the centre, unit length
  vec2 lit_turns;  // times what is lit of it
  vec2 rim;  // the same, of the outer half
  vec2 lit_rim;
};

const TapSums NO_TAPS = TapSums(0.0, vec2(0.0), vec2(0.0), vec2(0.0), vec2(0.0));

void add_tap(inout TapSums sums, float lit, vec2 turn, bool at_rim) {
  sums.lit += lit;
  sums.turns += turn;
  sums.lit_turns += lit * turn;
  if (at_rim) {
    sums.rim += turn;
    sums.lit_rim += lit * turn;
  }
}

// By Gauss' theorem the slope is 2 / radius times the mean, around the rim, of what is lit times the way from the centre. The
// rings of the outer half stand for the rim.
Lit lit_disc(TapSums sums, uint taps, mat2x3 axes, float radius_m) {
  float part = sums.lit / float(taps);
  return Lit(part, axes * ((sums.lit_rim - part * sums.rim) * (4.0 / (radius_m * float(taps)))));
}

// Towards what is lit: nothing where all taps are alike, but some way nevertheless.
vec2 way_to_lit(TapSums sums, uint taps) {
  return sums.lit_turns - sums.lit / float(taps) * sums.turns + vec2(1e-6, 0.0);
}

struct Blockers {
  uint count;
  float sum;  // of their blocker_place()
  uint taps;
};

// Where a blocker stands. For a cube: the part of the way from the centre to the plane. For a cascade: its distance from the plane
// along the light's way, of the cascade's whole depth.
float blocker_place(CubeDisc disc, Tap tap, float blocker) { return tap.depth / blocker; }
float blocker_place(CascadeDisc disc, Tap tap, float blocker) { return blocker - tap.depth; }

#define DISC CubeDisc
#include "shadows/filter/disc_taps.glsl"
#undef DISC
#define DISC CascadeDisc
#include "shadows/filter/disc_taps.glsl"
#undef DISC

// The lit part of a disc, from this pixel's taps and from those of its block's that lie nearer than half the radius. Theirs
// are put right by how much changes on the way.
float lit_of_block(vec3 p, uint mates, Lit own, float radius_m) {
  mates &= block_ballot(true);
  float weights = 1.0;
  float part = own.part;
  vec3 slope = own.slope;
  vec3 away = vec3(0.0);
  for (uint i = 1u; i < BLOCK_PIXELS; ++i) {
    vec3 way = subgroupShuffleXor(p, i) - p;
    float its_part = subgroupShuffleXor(own.part, i);
    vec3 its_slope = subgroupShuffleXor(own.slope, i);
    float weight = clamp(2.0 - length(way) / (SHARE_RADII * radius_m), 0.0, 1.0);
    if (has_bit(mates, block_place() ^ i) && weight > 0.0) {  // what others say may be no number
      weights += weight;
      part += weight * its_part;
      slope += weight * its_slope;
      away += weight * way;
    }
  }
  return clamp((part - dot(slope, away) / weights) / weights, 0.0, 1.0);
}

float visibility_pcf(ShadowMap map, Receiver r) {
  if (is_projected(map, PROJECTION_CASCADE)) {
    ShadowView cascade = views[cascade_at(map, r.p)];
    float cascade_radius_m = max(SMOOTHING_TEXELS * cascade.texel_m, PENUMBRA_PER_RADIUS * map.filter_radius_m);
    Lit own = lit_by_taps(cascade_disc(map, cascade, r.p, r.n, r.axes), r.axes, cascade_radius_m, DISC_TAPS);
    return lit_of_block(r.p, facing_mates(r, depth_per_m(cascade)), own, cascade_radius_m);
  }
  float radius_m = pcf_radius(map, r.p);
  Lit own = lit_by_taps(cube_disc(map, r.p, r.n, r.axes, radius_m), r.axes, radius_m, DISC_TAPS);
  return lit_of_block(r.p, facing_mates(r, -from_center(map, r.p)), own, radius_m);
}

#endif
