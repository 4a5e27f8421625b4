// SPDX-License-Identifier: Apache-2.0
// Cull answer `light-frustum`: a box against the light's sphere and the view's six planes. Conservative. A box within
// another box never passes a test that the other one fails, since clamps, differences, products and sums all round
// monotonically: blocks are tested as their members are.
#version 460
#extension GL_GOOGLE_include_directive : require
#define TESTS_BLOCKS
#include "shadows/cull/cull.glsl"

// Is a box within the light's range?
bool reaches(ShadowView view, BlockBox box) {
  vec3 nearest = clamp(view.center_ws, box.min_ws, box.max_ws);
  precise vec3 d = nearest - view.center_ws;
  precise float distance2 = dot(d, d);
  return view.range_m == 0.0 || distance2 <= view.range_m * view.range_m;
}

// Is the box's corner farthest along the plane's normal inside? All of them from the view's centre.
bool inside(vec4 plane, vec3 low, vec3 high) {
  vec3 corner = mix(low, high, greaterThan(plane.xyz, vec3(0.0)));
  precise float above = dot(plane.xyz, corner) + plane.w;
  return above >= 0.0;
}

bool meets_frustum(ShadowView view, BlockBox box) {
  precise mat4 rows = transpose(mat4(view.clip_from_center[0], view.clip_from_center[1], view.clip_from_center[2],
                                     view.clip_from_center[3]));
  precise vec3 low = box.min_ws - view.center_ws, high = box.max_ws - view.center_ws;
  precise vec4 left = rows[3] + rows[0], right = rows[3] - rows[0], top = rows[3] + rows[1], bottom = rows[3] - rows[1];
  precise vec4 front = rows[3] - rows[2];
  return inside(left, low, high) && inside(right, low, high) && inside(top, low, high) && inside(bottom, low, high) &&
         inside(front, low, high) && inside(rows[2], low, high);
}

bool may_survive(ShadowView view, BlockBox box) { return reaches(view, box) && meets_frustum(view, box); }

bool survives(ShadowView view, BatchInstance candidate) {
  return may_survive(view, BlockBox(candidate.bounds_min_ws, candidate.bounds_max_ws));
}
