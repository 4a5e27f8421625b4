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

// That the frame's maps have: a bit for each Projection. Answers have the numbers below.
layout(constant_id = 100) const uint projections = 3u;
layout(constant_id = 101) const bool parts_of_layers = false;  // a map has no whole layers

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

#include "shading/brdf.glsl"
#include "shadows/filter/receiver_disc.glsl"
#include "stages/lookup.glsl"
#include "stages/filter.glsl"
#include "stages/deliver.glsl"
#include "stages/shade.glsl"
