// SPDX-License-Identifier: Apache-2.0
// Deliver answer `textures`: shading reads what visibility.comp has written.
#ifndef CHANDELIER_DELIVER_TEXTURES_GLSL
#define CHANDELIER_DELIVER_TEXTURES_GLSL

// LightCluster §3.2.2: beyond C_att no light of the map reaches. p: from the eye.
bool in_range(ShadowMap map, vec3 p) {
  return map.projection == PROJECTION_CASCADE || length(from_center(map, p)) < map.range_m;
}

// Where a map's visibility texture keeps a pixel; NONE outside its rectangle.
uint visibility_place(ShadowMap map, uvec2 pixel) {
  uvec2 at = pixel - uvec2(map.rect_x, map.rect_y);  // left of it or above it wraps around to very large
  bool inside = at.x < map.rect_width && at.y < map.rect_height;
  return inside ? map.first_visibility + at.y * map.rect_width + at.x : NONE;
}

float delivered_textures(ShadowMap map, Receiver receiver, uvec2 pixel) {
  uint place = visibility_place(map, pixel);
  return place != NONE && in_range(map, receiver.p) ? float(uint(visibility_bytes[place])) / 255.0 : 0.0;
}

#endif
