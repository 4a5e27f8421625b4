// SPDX-License-Identifier: Apache-2.0
// Which surfaces four neighbouring texels show. Expects in scope what shadow_lookup.glsl does, and the depths without
// comparison: `sampler2DArray layer_depths`, a layer for each face and cascade.
//
// A plane is kept as a view sees it: at (u, v), -1 to 1 across the view, its depth is plane.x * u + plane.y * v + plane.z.
// That is exact in a cascade and, as depth is near / distance along the axis, on the face of a cube.
#ifndef CHANDELIER_TEXELS_GLSL
#define CHANDELIER_TEXELS_GLSL
#include "shadows/filter/shadow_lookup.glsl"

// Four texels around the place where they meet, in textureGather's order.
struct Texels {
  vec4 depth;
  vec2 middle;  // u and v of that place
  float size;   // of the view, texels
};
const vec4 RIGHT = vec4(-1.0, 1.0, 1.0, -1.0), DOWN = vec4(1.0, 1.0, -1.0, -1.0);  // half texels from the middle

// The four whose centres surround uv; beside the view's border the nearest four within.
Texels texels_at(Square square, vec2 uv, float layer) {
  vec2 at = clamp(floor((uv * 0.5 + 0.5) * square.size + 0.5), 1.0, square.size - 1.0);
  vec4 depth = textureGather(layer_depths, vec3((square.corner + at) / view.face_size_px, layer));
  return Texels(depth, at / square.size * 2.0 - 1.0, square.size);
}

// A plane's depth at the centres of four texels.
vec4 plane_at(vec3 plane, Texels t) {
  return dot(plane, vec3(t.middle, 1.0)) + (plane.x * RIGHT + plane.y * DOWN) / t.size;
}

// The plane that four texels lie on, or come nearest to.
vec3 plane_through(Texels t) {
  vec2 slope = vec2(dot(t.depth, RIGHT), dot(t.depth, DOWN)) * (0.25 * t.size);
  return vec3(slope, dot(t.depth, vec4(0.25)) - dot(slope, t.middle));
}

// A point that is to be lit, and its surface's plane, as a layer sees them.
struct Spot {
  vec3 plane;
  float depth;
  float texel;     // a texel's width, as a difference of depth
  float rounding;  // of depth on its way into the map and out of it
  bool faces;      // the surface faces the map's centre
};

// What lies within so many texels of a spot's plane is its own surface.
const float OWN_TEXELS = 0.1;
// What is less than this many texels before a spot may meet its surface right there, aslant.
const float TOUCH_TEXELS = 16.0;

// What four texels show of a spot's surroundings.
struct Sight {
  bvec4 own;      // the spot's own surface
  bvec4 before;   // what is nearer to the light than the spot and its plane
  bvec4 touches;  // of that, what is so little nearer that it may meet the spot's surface within a few texels
};

Sight sight(Texels t, Spot spot) {
  vec4 plane = plane_at(spot.plane, t);
  float step = 2.0 / t.size * (abs(spot.plane.x) + abs(spot.plane.y)) + spot.texel;
  float error = OWN_TEXELS * step + spot.rounding;
  bvec4 own = lessThanEqual(abs(t.depth - plane), vec4(spot.faces ? error : -1.0));
  bvec4 before = greaterThan(t.depth, max(plane + (spot.faces ? error : -error), vec4(spot.depth + spot.rounding)));
  bvec4 near = lessThanEqual(t.depth, vec4(spot.depth + TOUCH_TEXELS * spot.texel));
  return Sight(own, before, bvec4(uvec4(before) & uvec4(near)));
}

// So far beside a spot's surface, texels lie on the other one that it meets: whole texels away from where they do.
const float ASIDE_TEXELS = 2.25;

// Is a spot at uv on the light's side of another plane, or on it?
bool has_before_it(vec3 plane, Spot spot, vec2 uv) {
  return dot(plane, vec3(uv, 1.0)) <= spot.depth + OWN_TEXELS * spot.texel;
}

// Do the texels show a spot's surface where they do not show that other plane? Where both meet, a texel may look like either.
bool shows_it_alone(Texels t, Sight s, Spot spot, vec3 plane) {
  bvec4 apart = greaterThan(abs(t.depth - plane_at(plane, t)), vec4(OWN_TEXELS * spot.texel));
  return any(bvec4(uvec4(s.own) & uvec4(apart)));
}

// The coordinates of v along u, v and the axis of the cube's face that `at` falls on.
vec3 to_face(vec3 at, vec3 v) {
  vec3 a = abs(at);
  if (a.x >= max(a.y, a.z)) return vec3(-v.z, -v.y, v.x) * vec3(sign(at.x), 1.0, sign(at.x));
  if (a.y >= a.z) return v.xzy * vec3(1.0, sign(at.y), sign(at.y));
  return vec3(v.x, -v.y, v.z) * vec3(sign(at.z), 1.0, sign(at.z));
}

// The other way.
vec3 from_face(vec3 at, vec3 v) {
  vec3 a = abs(at);
  if (a.x >= max(a.y, a.z)) return vec3(sign(at.x) * v.z, -v.y, -sign(at.x) * v.x);
  if (a.y >= a.z) return vec3(v.x, sign(at.y) * v.z, sign(at.y) * v.y);
  return vec3(sign(at.z) * v.x, -v.y, sign(at.z) * v.z);
}

float face_of(vec3 at) {
  vec3 a = abs(at);
  if (a.x >= max(a.y, a.z)) return at.x > 0.0 ? 0.0 : 1.0;
  if (a.y >= a.z) return at.y > 0.0 ? 2.0 : 3.0;
  return at.z > 0.0 ? 4.0 : 5.0;
}

// The four texels of a cube on the way to `at`, from its centre.
Texels cube_texels(Square square, float cube, vec3 at) {
  vec3 on_face = to_face(at, at);
  return texels_at(square, on_face.xy / on_face.z, 6.0 * cube + face_of(at));
}

// The surface through d across n, where d is from the cube's centre, as the face sees it that `at` falls on. It is tilted by
// the least bit towards the centre, since a plane that is seen edge on has no depth.
Spot cube_spot(float near_m, float size, vec3 d, vec3 n, vec3 at) {
  float depth = near_m / largest(abs(d));
  vec3 tilted = n - d * (1e-4 / largest(abs(d)));
  float facing = dot(tilted, d);
  return Spot(to_face(at, tilted) * (near_m / facing), depth, 2.0 / size * depth, DEPTH_ROUNDING * depth,
              facing < 0.0);
}

// A cascade's centre is the eye.
vec3 to_cascade(ShadowView cascade, vec4 p) {
  return vec3(mat4(cascade.clip_from_center[0], cascade.clip_from_center[1], cascade.clip_from_center[2],
                   cascade.clip_from_center[3]) * p);
}

// The g-buffer's normals are rounded, which turns planes that the sun shines along.
const float NORMAL_TEXELS = 0.02;

// The surface across n through what is `clip` in a cascade. The cascade's axes are at right angles, and its depth falls along
// the light's way.
Spot cascade_spot(ShadowView cascade, vec3 clip, vec3 n) {
  mat3 rows = transpose(mat3(vec3(cascade.clip_from_center[0]), vec3(cascade.clip_from_center[1]),
                             vec3(cascade.clip_from_center[2])));
  float depth2 = dot(rows[2], rows[2]);
  float facing = dot(rows[2], n) + 1e-4 * sqrt(depth2);
  vec2 slope = -vec2(dot(rows[0], n) / dot(rows[0], rows[0]), dot(rows[1], n) / dot(rows[1], rows[1])) * (depth2 / facing);
  float texel = cascade.texel_m * sqrt(depth2);
  float rounding = CASCADE_ROUNDING + NORMAL_TEXELS * texel;
  return Spot(vec3(slope, clip.z - dot(slope, clip.xy)), clip.z, texel, rounding, facing > 0.0);
}

#endif
