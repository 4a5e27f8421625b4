// SPDX-License-Identifier: Apache-2.0
// Filter answer `hard`: one comparison with the nearest texel, put right where its neighbours know better.
#ifndef CHANDELIER_FILTER_HARD_GLSL
#define CHANDELIER_FILTER_HARD_GLSL
#include "shadows/filter/receiver_disc.glsl"

// The texel nearest to uv decides, but where two surfaces meet it may be the other one's. If no texel around the spot shows its
// own surface, that ends behind the edge of what shadows it, and light that passes by beyond the edge is not for it. If one
// does, the other surface's plane, which texels farther that way lie on, has the spot before it or behind it.
float nearest_lit(Square square, Spot spot, vec2 uv, float layer) {
  Texels around = texels_at(square, uv, layer);
  Sight here = sight(around, spot);
  bvec2 beyond = greaterThanEqual(uv, around.middle);
  uvec4 nearest = uvec4(!beyond.x && beyond.y, beyond.x && beyond.y, beyond.x && !beyond.y, !beyond.x && !beyond.y);
  bool is_blocked = any(bvec4(nearest & uvec4(here.before)));
  bool touches = is_blocked ? any(bvec4(nearest & uvec4(here.touches))) : any(here.touches);
  float lit = float(!is_blocked && !touches);
  if (touches && any(here.own)) {
    vec2 way = vec2(dot(vec4(here.before), RIGHT), dot(vec4(here.before), DOWN));
    way *= ASIDE_TEXELS * 2.0 / square.size * inversesqrt(max(dot(way, way), 1e-4));
    vec3 plane = plane_through(texels_at(square, around.middle + way, layer));
    lit = float(has_before_it(plane, spot, uv) || (!is_blocked && shows_it_alone(around, here, spot, plane)));
  }
  return lit;
}

float visibility_hard(ShadowMap map, Receiver r) {
  Square square = square_of(map);
  if (is_projected(map, PROJECTION_CASCADE)) {
    ShadowView cascade = views[cascade_at(map, r.p)];
    vec3 clip = to_cascade(cascade, vec4(r.p, 1.0));
    return nearest_lit(square, cascade_spot(cascade, clip, r.n), clip.xy, float(cascade.layer));
  }
  vec3 d = from_center(map, r.p);
  vec3 on_face = to_face(d, d);
  return nearest_lit(square, cube_spot(map.near_m, square.size, d, r.n, d), on_face.xy / on_face.z, float(6u * map.cube) + face_of(d));
}

#endif
