// SPDX-License-Identifier: Apache-2.0
// From a pixel and its depth to a position from the eye, along the world's axes. `pixel` is in pixels, (0.5, 0.5) the middle
// of the first.
#ifndef CHANDELIER_EYE_POSITION_GLSL
#define CHANDELIER_EYE_POSITION_GLSL

// Homogeneous; at depth 0 a direction.
vec4 eye_point(ViewConstants view, vec2 pixel, float depth) {
  vec2 clip = pixel / view.size_px * 2.0 - 1.0;
  return mat4(view.eye_from_clip[0], view.eye_from_clip[1], view.eye_from_clip[2], view.eye_from_clip[3]) *
         vec4(clip, depth, 1.0);
}

vec3 eye_position(ViewConstants view, vec2 pixel, float depth) {
  vec4 p = eye_point(view, pixel, depth);
  return p.xyz / p.w;
}

#endif
