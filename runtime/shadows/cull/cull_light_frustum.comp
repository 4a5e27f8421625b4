// SPDX-License-Identifier: Apache-2.0
// Cull answer `light-frustum`: a batch's box against the light's sphere and the view's six planes. Conservative.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shadows/cull/cull.glsl"

bool reaches(ShadowView view, BatchInstance candidate) {
  vec3 nearest = clamp(view.center_ws, candidate.bounds_min_ws, candidate.bounds_max_ws);
  vec3 d = nearest - view.center_ws;
  return view.range_m == 0.0 || dot(d, d) <= view.range_m * view.range_m;
}

// Is the box's corner farthest along the plane's normal inside? All of them from the view's centre.
bool inside(vec4 plane, vec3 low, vec3 high) {
  vec3 corner = mix(low, high, greaterThan(plane.xyz, vec3(0.0)));
  return dot(plane.xyz, corner) + plane.w >= 0.0;
}

bool survives(ShadowView view, BatchInstance candidate) {
  if (!reaches(view, candidate)) return false;
  mat4 rows = transpose(mat4(view.clip_from_center[0], view.clip_from_center[1], view.clip_from_center[2],
                             view.clip_from_center[3]));
  vec3 low = candidate.bounds_min_ws - view.center_ws, high = candidate.bounds_max_ws - view.center_ws;
  return inside(rows[3] + rows[0], low, high) && inside(rows[3] - rows[0], low, high) &&
         inside(rows[3] + rows[1], low, high) && inside(rows[3] - rows[1], low, high) &&
         inside(rows[3] - rows[2], low, high) && inside(rows[2], low, high);
}
