// SPDX-License-Identifier: Apache-2.0
// The g-buffer's vertices. A draw's first_instance is its own number among the draws.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "frame_schema.glsl"
#include "pack_schema.glsl"
#include "scene/instance.glsl"
#include "scene/octahedral.glsl"
#include "shading/uv_transform.glsl"

layout(binding = 0, scalar) readonly buffer Views { ViewConstants view; };
layout(binding = 1, scalar) readonly buffer Draws { CasterDraw draws[]; };
layout(binding = 2, scalar) readonly buffer Instances { Instance instances[]; };
layout(binding = 3, scalar) readonly buffer Materials { Material materials[]; };

layout(location = 0) in vec3 position_ls;
layout(location = 1) in uint normal_bits;
layout(location = 2) in uint tangent_bits;
layout(location = 3) in vec2 uv0_in;
layout(location = 4) in vec2 uv1_in;
layout(location = 5) in vec4 color_in;

layout(location = 0) out vec3 position_from_eye;
layout(location = 1) out vec3 normal_ws;
layout(location = 2) out vec4 tangent_ws;
layout(location = 3) out vec2 uv[5];
layout(location = 8) out vec4 color;
layout(location = 9) flat out uint material;

void main() {
  CasterDraw draw = draws[gl_InstanceIndex];
  vec4 rows[3] = instances[draw.instance].world_from_local;
  position_from_eye = position_from(view.eye_ws, rows, position_ls);
  normal_ws = normal_to_world(rows, decode_normal(normal_bits));
  // The bitangent's sign refers to the unmirrored frame.
  float mirror = determinant(mat3(rows[0].xyz, rows[1].xyz, rows[2].xyz)) < 0.0 ? -1.0 : 1.0;
  vec4 tangent_ls = decode_tangent(tangent_bits);
  tangent_ws = vec4(direction_to_world(rows, tangent_ls.xyz), tangent_ls.w * mirror);
  uint uv1_mask = materials[draw.material].uv1_mask;
  for (uint i = 0u; i < 5u; ++i) uv[i] = uv_of(uv1_mask, draw.material, i, uv0_in, uv1_in);
  color = color_in;
  material = draw.material;
  gl_Position = mat4(view.clip_from_eye[0], view.clip_from_eye[1], view.clip_from_eye[2], view.clip_from_eye[3]) *
                vec4(position_from_eye, 1.0);
}
