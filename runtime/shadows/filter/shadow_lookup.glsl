// SPDX-License-Identifier: Apache-2.0
// What all filters need. Expects in scope: `ShadowView views[]`, `ViewConstants view` and the constant `projections`; the soft filters also
// `samplerCubeArrayShadow cubes` and `sampler2DArrayShadow layers`, where a comparison passes if the reference is greater or
// equal: depth is reversed. Points come as positions from the camera's eye, along the world's axes:
// what is seen is exact there, however far from the world's origin.
#ifndef CHANDELIER_SHADOW_LOOKUP_GLSL
#define CHANDELIER_SHADOW_LOOKUP_GLSL

// Float rounding of depth on its way through matrix, rasterizer and sampler, relative.
const float DEPTH_ROUNDING = 1e-4;

// `projections` has a bit for each projection that the frame's maps have. A shader is specialized for them: a driver that
// executes both sides of a branch would pay for the projection that no map has.
bool is_projected(ShadowMap map, uint projection) {
  if ((projections & 1u << projection) == 0u) return false;
  return projections == 1u << projection || map.projection == projection;
}

// A point as the centre of a map sees it.
vec3 from_center(ShadowMap map, vec3 p) { return p + (view.eye_ws - map.center_ws); }

// The square of its layers that a map has, in texels. Layers are view.face_size_px wide.
struct Square {
  vec2 corner;
  float size;
};
Square square_of(ShadowMap map) { return Square(vec2(map.left_px, map.top_px), float(map.size_px)); }

float largest(vec3 v) { return max(v.x, max(v.y, v.z)); }

// The part of n along the axis of the cube face that d falls on; where d is within `reach` of other faces, the least part
// along any of their axes.
float along_major_axis(vec3 d, vec3 n, float reach) {
  vec3 a = abs(d);
  vec3 along = mix(vec3(1.0), abs(n), greaterThanEqual(a + reach, vec3(largest(a))));
  return min(along.x, min(along.y, along.z));
}

// Width of a texel of the map at p, metres. For a cube it grows with the distance along the face's axis.
float texel_size(ShadowMap map, vec3 p) {
  return 2.0 / float(map.size_px) * largest(abs(from_center(map, p)));
}

// The first cascade that reaches as far as p.
uint cascade_at(ShadowMap map, vec3 p) {
  float depth = dot(p, view.forward_ws);
  uint last = map.first_view + map.view_count - 1u;
  uint cascade = map.first_view;
  while (cascade < last && depth > views[cascade].far_m) ++cascade;
  return cascade;
}

// A cascade's depth is even over the whole scene: rounding is a few units of the 24th bit of its range.
const float CASCADE_ROUNDING = 2e-6;

// How much a cascade's depth grows a metre farther on along each axis: it points towards the light.
vec3 depth_per_m(ShadowView cascade) {
  return vec3(cascade.clip_from_center[0].z, cascade.clip_from_center[1].z, cascade.clip_from_center[2].z);
}

#endif
