// SPDX-License-Identifier: Apache-2.0
// Ambient light for any normal, without a picture.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "frame_schema.glsl"
#include "shading/ambient.glsl"

layout(local_size_x = 64) in;
layout(binding = 0, scalar) readonly buffer View { ViewConstants view; };
layout(binding = 1, scalar) readonly buffer Normals { vec3 normals[]; };
layout(binding = 2, scalar) writeonly buffer Answers { vec3 answers[]; };

void main() {
  uint i = gl_GlobalInvocationID.x;
  if (i < uint(normals.length())) answers[i] = ambient_at(view.ambient, normals[i]);
}
