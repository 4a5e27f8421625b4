// SPDX-License-Identifier: Apache-2.0
// Reads a filter at any point, without a picture.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#extension GL_KHR_shader_subgroup_ballot : require
#extension GL_KHR_shader_subgroup_shuffle : require
#extension GL_KHR_shader_subgroup_vote : require
#include "frame_schema.glsl"

struct Question {
  vec3 p;
  uint map;
  vec3 n;
};

layout(local_size_x = 64) in;
layout(binding = 0, scalar) readonly buffer View { ViewConstants view; };
layout(binding = 1, scalar) readonly buffer Maps { ShadowMap maps[]; };
layout(binding = 2, scalar) readonly buffer Views { ShadowView views[]; };
layout(binding = 3, scalar) readonly buffer Questions { Question questions[]; };
layout(binding = 4, scalar) writeonly buffer Answers { float answers[]; };
layout(binding = 5) uniform sampler2DArray layer_depths;
layout(binding = 6) uniform samplerCubeArrayShadow cubes;
layout(binding = 7) uniform sampler2DArrayShadow layers;
layout(binding = 8) uniform samplerCubeArray cube_depths;

layout(constant_id = 100) const bool parts_of_layers = false;
const uint projections = 1u << PROJECTION_CUBE_FACE | 1u << PROJECTION_CASCADE;
#include "stages/filter.glsl"

void main() {
  uint i = gl_GlobalInvocationID.x;
  if (i >= uint(questions.length())) return;
  Question q = questions[i];
  answers[i] = visibility(maps[q.map], receiver_at(q.p, q.n));
}
