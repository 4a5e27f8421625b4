// SPDX-License-Identifier: Apache-2.0
// What a group's dispatches over the picture read: visibility.comp fills visibility textures, shade.comp adds light.
#extension GL_EXT_shader_8bit_storage : require
#extension GL_KHR_shader_subgroup_ballot : require
#extension GL_KHR_shader_subgroup_shuffle : require
#extension GL_KHR_shader_subgroup_vote : require
#include "frame_schema.glsl"
#include "pack_schema.glsl"
#include "shading/surface.glsl"
#include "shading/eye_position.glsl"

layout(constant_id = 0) const uint filter_answer = 0u;
layout(constant_id = 1) const uint shade_answer = 0u;
layout(constant_id = 2) const uint lookup_answer = 0u;
layout(constant_id = 3) const uint deliver_answer = 0u;
layout(constant_id = 4) const uint projections = 3u;  // that the frame's maps have: PROJECTION_CUBE | PROJECTION_CASCADES

layout(local_size_x = 8, local_size_y = 8) in;
layout(binding = 0, scalar) readonly buffer View { ViewConstants view; };
layout(binding = 1, scalar) readonly buffer Lights { FrameLight lights[]; };
layout(binding = 2, scalar) readonly buffer Maps { ShadowMap maps[]; };
layout(binding = 3, scalar) readonly buffer Views { ShadowView views[]; };
layout(binding = 4) uniform usampler2D surface_image;
layout(binding = 5) uniform sampler2D depth_image;
layout(binding = 6) uniform samplerCubeArrayShadow cubes;
layout(binding = 7) uniform sampler2DArrayShadow layers;
layout(binding = 8, rgba32f) uniform image2D radiance_image;
layout(binding = 9, scalar) readonly buffer TileWords { TileWord tile_words[]; };
layout(binding = 10, scalar) buffer Visibility { uint8_t visibility_bytes[]; };
layout(binding = 11) uniform samplerCubeArray cube_depths;
layout(binding = 12) uniform sampler2DArray layer_depths;
layout(push_constant, scalar) uniform Push { ShadeConstants group; };

#include "lookup/lookup.glsl"
#include "shadows/filter/visibility.glsl"

// LightCluster §3.2.2: beyond C_att no light of the map reaches. p: from the eye.
bool in_range(ShadowMap map, vec3 p) {
  return map.is_directional != 0u || length(from_center(map, p)) < map.range_m;
}

// Where a map's visibility texture keeps a pixel; NONE outside its rectangle.
uint visibility_place(ShadowMap map, uvec2 pixel) {
  uvec2 at = pixel - uvec2(map.rect_x, map.rect_y);  // left of it or above it wraps around to very large
  bool inside = at.x < map.rect_width && at.y < map.rect_height;
  return inside ? map.first_visibility + at.y * map.rect_width + at.x : NONE;
}
