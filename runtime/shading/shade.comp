// SPDX-License-Identifier: Apache-2.0
// Adds the light of one group's ShadowMaps to the picture: delivery `inline` filters them here, `textures` reads what
// visibility.comp left.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shading/group.glsl"
#include "shading/occlusion.glsl"
#include "shading/shade.glsl"
#include "shading/strips.glsl"

float visible_part(uint number, Receiver receiver, uvec2 pixel) { return delivered(maps[number], receiver, pixel); }

void main() {
  ivec2 pixel = ivec2(pixel_of_thread());
  if (any(greaterThanEqual(vec2(pixel), view.size_px))) return;
  float depth = texelFetch(depth_image, pixel, 0).r;
  vec4 radiance = imageLoad(radiance_image, pixel);
  if (depth == 0.0 || is_unlit(radiance.a) || group.first_light == group.light_end) return;
  Surface s = unpack_surface(texelFetch(surface_image, pixel, 0));
  vec3 p = eye_position(view, vec2(pixel) + 0.5, depth);
  imageStore(radiance_image, pixel, vec4(radiance.rgb + lit_by_group(s, p, uvec2(pixel)), radiance.a));
}
