// SPDX-License-Identifier: Apache-2.0
// Filter answer `hard`: one comparison with the nearest texel.
#include "shadows/filter/shadow_lookup.glsl"

float hard_visibility(ShadowMap map, vec3 p, vec3 n) {
  const float texels = 0.75;  // a texel's centre lies within half its diagonal
  if (map.is_directional != 0u) {
    ShadowView cascade = views[cascade_at(map, p)];
    return cascade_lit(cascade, p + n * (texels * cascade.texel_m));
  }
  return cube_lit(map, offset_from_surface(map, p, n, texels));
}
