// SPDX-License-Identifier: Apache-2.0
// Where taps of a disc disagree: is it a shadow's edge, or does the receiver meet another surface there?
//
// A surface does not shadow what lies on the light's side of its plane: where a receiver's surface is seen, the plane is looked
// for that the blocked taps met, and if it is such a one they are compared with that plane, too. And a receiver whose surface
// no texel shows, behind the edge of what shadows it, is not lit by what passes by beyond.
#ifndef CHANDELIER_CORNER_GLSL
#define CHANDELIER_CORNER_GLSL
#include "shadows/filter/receiver_disc.glsl"

// What is to be done about the taps of a disc.
struct Verdict {
  bool hidden;    // nothing is lit after all
  bool again;     // they are to be compared anew with `beside`
  Beside beside;
};

Beside with_plane(Beside beside, vec3 plane, float margin) {
  return Beside(plane, beside.first, max(margin, beside.margin));
}

// How far aside to look.
float step_aside(float radius, float texel) { return max(0.7 * radius, ASIDE_TEXELS * texel); }

// `plane`: what texels aside lie on, as the layer sees it that the spot is in. `own_aside`: they show the spot's own surface.
Verdict verdict(Texels around, Sight here, Spot spot, vec2 uv, vec3 plane, bool own_aside, Beside beside) {
  bool shown = any(here.own);
  bool before = has_before_it(plane, spot, uv);
  bool touches = dot(plane, vec3(uv, 1.0)) <= spot.depth + TOUCH_TEXELS * spot.texel;
  bool hidden = shown ? !before && touches && !shows_it_alone(around, here, spot, plane) : any(here.touches) && !own_aside;
  return Verdict(hidden, shown && before, beside);
}

Verdict verdict_of(CubeDisc disc, vec2 way_to_lit, float radius_m) {
  vec3 n = cross(disc.axes[0], disc.axes[1]);
  vec3 d = disc.surface;
  Spot spot = cube_spot(disc.near_m, disc.square.size, d, n, d);
  Texels around = cube_texels(disc.square, disc.cube, d);
  Sight here = sight(around, spot);
  bool shown = any(here.own);
  vec3 aside = disc.axes * (shown ? -way_to_lit : way_to_lit);
  if (shown) aside -= d * (dot(aside, d) / dot(d, d));  // across the light's way: the map knows no other step
  float texel_m = 2.0 / disc.square.size * largest(abs(d));
  vec3 at = disc.receiver + aside * (step_aside(radius_m, texel_m) * inversesqrt(max(dot(aside, aside), 1e-20)));
  Texels there = cube_texels(disc.square, disc.cube, at);
  vec3 plane = from_face(at, plane_through(there));
  vec3 on_face = to_face(d, d);
  Beside beside = with_plane(disc.beside, plane, 2.0 / disc.square.size * dot(abs(plane), vec3(1.0)));
  bool own_aside = any(sight(there, cube_spot(disc.near_m, disc.square.size, d, n, at)).own);
  return verdict(around, here, spot, on_face.xy / on_face.z, to_face(d, plane), own_aside, beside);
}

Verdict verdict_of(CascadeDisc disc, vec2 way_to_lit, float radius_m) {
  Texels around = texels_at(disc.square, disc.uv, disc.layer);
  Sight here = sight(around, disc.spot);
  vec2 aside = (disc.axes * (any(here.own) ? -way_to_lit : way_to_lit)).xy;
  float steps = step_aside(radius_m / disc.texel_m, 1.0) * 2.0 / disc.square.size;
  Texels there = texels_at(disc.square, disc.receiver.xy + aside * (steps * inversesqrt(max(dot(aside, aside), 1e-20))), disc.layer);
  vec3 plane = plane_through(there);
  float margin = 2.0 / disc.square.size * (abs(plane.x) + abs(plane.y)) + disc.spot.texel;
  bool own_aside = any(sight(there, disc.spot).own);
  return verdict(around, here, disc.spot, disc.uv, plane, own_aside, with_plane(disc.beside, plane, margin));
}

#endif
