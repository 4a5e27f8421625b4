// SPDX-License-Identifier: Apache-2.0
// Deliver answer `textures` (LightCluster §3.2.2): one byte a pixel and map, read later by shade.comp. Only the rectangle
// that a map's lights can reach is kept, and only pixels within C_att are filtered.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shading/group.glsl"
#include "shading/strips.glsl"

// A light of each map in turns: of every map where the lookup gives lights in no order.
uint light_of_first_map() { return lookup_keeps_order() ? first_light() : group.first_light; }
uint light_of_next_map(uint light) {
  ShadowMap map = maps[lights[light].map];
  uint last = map.first_light + map.light_count - 1u;
  return lookup_keeps_order() ? light_after(last) : last + 1u;
}

void main() {
  ivec2 pixel = ivec2(pixel_of_thread());
  if (any(greaterThanEqual(vec2(pixel), view.size_px))) return;
  float depth = texelFetch(depth_image, pixel, 0).r;
  if (depth == 0.0 || group.first_light == group.light_end) return;
  vec3 n = unpack_surface(texelFetch(surface_image, pixel, 0)).geometric_normal;
  vec3 p = eye_position(view, vec2(pixel) + 0.5, depth);
  Receiver receiver = receiver_at(p, n);
  uint light = light_of_first_map();
  if (light < group.light_end) do {
    ShadowMap map = maps[lights[light].map];
    uint place = visibility_place(map, uvec2(pixel));
    bool reached = place != NONE && in_range(map, p);
    if (subgroupAny(reached)) {
      uint visible = uint(visibility(map, receiver) * 255.0 + 0.5);
      if (reached) visibility_bytes[place] = uint8_t(visible);
    }
    light = light_of_next_map(light);
  } while (light < group.light_end);
}
