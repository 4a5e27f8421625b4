// SPDX-License-Identifier: Apache-2.0
// A disc of taps in the receiver's plane: a flat receiver never shadows itself however wide the disc is.
#ifndef CHANDELIER_RECEIVER_DISC_GLSL
#define CHANDELIER_RECEIVER_DISC_GLSL
#include "shadows/filter/block.glsl"
#include "shadows/filter/texels.glsl"

const float SMOOTHING_TEXELS = 1.5;  // least radius: hides the staircase of a single light's map
const float RAISE_TEXELS = 1.5;      // bilinear comparison reads texels whose centres are up to a diagonal away

// A pixel's taps lie in rings of equal area, one in each, 152 degrees further on from ring to ring. In the block's next pixel
// all are 45 degrees further on, at another of eight radii within their rings. So a pixel's taps are about even over the disc,
// and those of a block as even as a golden spiral: over straight edges a pixel's own 8 err by 0.058 and the block's 64 by 0.012,
// with 16 by 0.036 and 0.007. Other turns were tried: the golden angle's leave all taps on eight spokes.
const mat2 NEXT_TURN = mat2(-0.882948, 0.469472, -0.469472, -0.882948);

// How far out tap `i` is in the unit disc.
float tap_ring(uint i, uint taps) {
  uint place = block_place();
  uint reversed = (place & 1u) << 2u | (place & 2u) | place >> 2u;
  return sqrt((float(i) + (float(reversed) + 0.5) / float(BLOCK_PIXELS)) / float(taps));
}

// Two unit vectors that span the plane across n, turned by this pixel's part of a turn. At 13 degrees the 128 taps of
// a block err least, by 0.005, where edges run along the world's axes, as most of a building's do.
mat2x3 receiver_axes(vec3 n) {
  vec3 t = normalize(abs(n.y) < 0.9 ? cross(n, vec3(0.0, 1.0, 0.0)) : cross(n, vec3(1.0, 0.0, 0.0)));
  vec3 b = cross(n, t);
  float angle = 0.2269 + 6.2831853 / float(BLOCK_PIXELS) * float(block_place());
  return mat2x3(cos(angle) * t + sin(angle) * b, cos(angle) * b - sin(angle) * t);
}

// What is needed of a pixel that taps are read for.
struct Receiver {
  vec3 p;
  vec3 n;
  mat2x3 axes;
  uint mates;  // block_mates()
};

Receiver receiver_at(vec3 p, vec3 n) { return Receiver(p, n, receiver_axes(n), block_mates(p, n)); }

// The mates that face the light or turn their backs on it as this pixel does: a plane that does is dark where a bent surface is
// lit. The lights of a cluster may reach what is turned away from the one that its map is drawn from.
uint facing_mates(Receiver r, vec3 to_light) {
  bool faces = dot(r.n, to_light) > 0.0;
  uint facing = block_ballot(faces);
  return r.mates & block_ballot(true) & (faces ? facing : ~facing);
}

// Up to two other surfaces beside the receiver. It lies on the light's side of their planes, so that they cannot shadow it.
struct Beside {
  vec3 first, second;  // planes as in texels.glsl; of a cube: the depth on the way to `at` is dot(plane, at) / largest(abs(at))
  float margin;        // by how much more depth than that they may show
};
const uint MOST_BESIDE = 2u;
const Beside NOTHING_BESIDE = Beside(vec3(0.0), vec3(0.0), 0.0);

// The most depth that they have on the way to `at`.
float depth_beside(Beside beside, vec3 at) { return max(dot(beside.first, at), dot(beside.second, at)); }

// A receiver's plane as the centre of a cube sees it.
struct CubeDisc {
  vec3 surface;   // the receiver from the centre, metres
  vec3 receiver;  // the same, off its surface
  mat2x3 axes;    // unit vectors in the plane
  vec2 slope;     // how much farther away the plane is a metre along each axis, relative to the receiver's distance
  Square square;
  float cube;
  float near_m;
  bool lone;  // one light shines from there: what it does not reach is not lit by another that shares the map
  Beside beside;
};

// For taps up to radius_m from the receiver: they may fall on other faces than p does, at other slopes, which is why the
// whole plane is moved by what the worst of them needs.
CubeDisc cube_disc(ShadowMap map, vec3 p, vec3 n, mat2x3 axes, float radius_m) {
  vec3 d = from_center(map, p);
  float raise_m = RAISE_TEXELS * 2.0 / float(map.size_px) * (largest(abs(d)) + radius_m);
  float across = along_major_axis(d, n, raise_m + 1.4142136 * radius_m);
  vec3 off = d + n * (raise_m * sqrt(max(0.0, 1.0 - across * across)));
  return CubeDisc(d, off, axes, off * axes / dot(off, off), square_of(map), float(map.cube), map.near_m, map.light_count == 1u, NOTHING_BESIDE);
}

// A tap of the disc: where the plane lies there and its depth.
struct Tap {
  vec3 at;
  float depth;
  float compared;  // no farther away than the receiver is: what is farther cannot shadow it, though in a concave corner it
                   // may stand before the tap
};

Tap tap_at(CubeDisc disc, vec2 at_m) {
  vec3 at = disc.receiver + disc.axes * at_m;
  float along = largest(abs(at));
  float depth = disc.near_m / (along * (1.0 - DEPTH_ROUNDING));
  float beside = depth_beside(disc.beside, at) / along + disc.beside.margin;
  return Tap(at, depth, max(depth * max(1.0, 1.0 + dot(disc.slope, at_m)), beside));
}

// A receiver's plane in a cascade.
struct CascadeDisc {
  vec2 uv;  // where the receiver is
  Spot spot;
  vec3 receiver;  // clip space; off its surface
  mat2x3 axes;    // a metre along each
  Square square;
  float layer;
  float texel_m;
  bool lone;
  Beside beside;
};

CascadeDisc cascade_disc(ShadowMap map, ShadowView cascade, vec3 p, vec3 n, mat2x3 axes) {
  vec3 surface = to_cascade(cascade, vec4(p, 1.0));
  vec3 receiver = surface + to_cascade(cascade, vec4(n * (RAISE_TEXELS * cascade.texel_m), 0.0));
  mat2x3 clip_axes = mat2x3(to_cascade(cascade, vec4(axes[0], 0.0)), to_cascade(cascade, vec4(axes[1], 0.0)));
  return CascadeDisc(surface.xy, cascade_spot(cascade, surface, n), receiver, clip_axes, square_of(map), float(cascade.layer),
                     cascade.texel_m, map.light_count == 1u, NOTHING_BESIDE);
}

Tap tap_at(CascadeDisc disc, vec2 at_m) {
  vec3 clip = disc.receiver + disc.axes * at_m;
  float beside = depth_beside(disc.beside, vec3(clip.xy, 1.0)) + disc.beside.margin;
  return Tap(vec3(clip.xy * 0.5 + 0.5, disc.layer), clip.z, max(max(clip.z, disc.receiver.z), beside) + CASCADE_ROUNDING);
}

#endif
