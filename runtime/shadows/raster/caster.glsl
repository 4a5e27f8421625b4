// SPDX-License-Identifier: Apache-2.0
// Casters of all views of a group in one pass: each draw chooses its layer. With MASKED also what an alpha test needs. With
// PLACED a view has a square of its layer, and clip distances keep it there; without, it has all of it.
#extension GL_GOOGLE_include_directive : require
#extension GL_ARB_shader_viewport_layer_array : require
#include "frame_schema.glsl"
#include "pack_schema.glsl"
#include "scene/instance.glsl"

layout(binding = 0, scalar) readonly buffer Views { ShadowView views[]; };
layout(binding = 1, scalar) readonly buffer Draws { CasterDraw draws[]; };
layout(binding = 2, scalar) readonly buffer Instances { Instance instances[]; };

layout(location = 0) in vec3 position_ls;
#ifdef PLACED
layout(push_constant, scalar) uniform Push { CasterConstants store; };
out gl_PerVertex {
  vec4 gl_Position;
  float gl_ClipDistance[4];
};

// From the view's own clip space to its square of the layer.
vec4 placed(ShadowView view, vec4 clip) {
  gl_ClipDistance[0] = clip.w + clip.x;
  gl_ClipDistance[1] = clip.w - clip.x;
  gl_ClipDistance[2] = clip.w + clip.y;
  gl_ClipDistance[3] = clip.w - clip.y;
  vec2 middle_px = vec2(view.left_px, view.top_px) + 0.5 * float(view.size_px);
  vec2 middle = middle_px / float(store.layer_size_px) * 2.0 - 1.0;
  return vec4(clip.xy * (float(view.size_px) / float(store.layer_size_px)) + middle * clip.w, clip.zw);
}
#else
vec4 placed(ShadowView view, vec4 clip) { return clip; }
#endif
#ifdef MASKED
#include "shading/uv_transform.glsl"
layout(binding = 3, scalar) readonly buffer Materials { Material materials[]; };
layout(location = 3) in vec2 uv0_in;
layout(location = 4) in vec2 uv1_in;
layout(location = 5) in vec4 color_in;
layout(location = 0) out vec2 uv;
layout(location = 1) out float alpha;
layout(location = 2) flat out float alpha_cutoff;
#endif

void main() {
  CasterDraw draw = draws[gl_InstanceIndex];
  ShadowView view = views[draw.shadow_view];
  vec3 p = position_from(view.center_ws, instances[draw.instance].world_from_local, position_ls);
  gl_Position = placed(view, mat4(view.clip_from_center[0], view.clip_from_center[1], view.clip_from_center[2],
                                  view.clip_from_center[3]) * vec4(p, 1.0));
  gl_Layer = int(view.layer);
#ifdef MASKED
  Material m = materials[draw.material];
  uv = uv_of(m.uv1_mask, draw.material, 0u, uv0_in, uv1_in);
  alpha = m.base_color_factor.a * color_in.a;
  alpha_cutoff = m.alpha_cutoff;
#endif
}
