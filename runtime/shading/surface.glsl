// SPDX-License-Identifier: Apache-2.0
// What the g-buffer keeps of a surface, in one RGBA32_UINT texel: x shading normal, y geometric normal (both octahedral,
// 16 bits a side), z base colour (square root, 10 bits a channel), w metallic and roughness (16 bits each).
#ifndef CHANDELIER_SURFACE_GLSL
#define CHANDELIER_SURFACE_GLSL
#include "scene/octahedral.glsl"

struct Surface {
  vec3 normal;            // unit length, as shading bends it
  vec3 geometric_normal;  // unit length, of the triangle; both face the camera
  vec3 base_color;
  float metallic;
  float roughness;
};

uvec4 pack_surface(Surface s) {
  uvec3 c = uvec3(sqrt(clamp(s.base_color, 0.0, 1.0)) * 1023.0 + 0.5);
  return uvec4(packSnorm2x16(octahedral(s.normal)), packSnorm2x16(octahedral(s.geometric_normal)),
               c.r | c.g << 10 | c.b << 20, packUnorm2x16(vec2(s.metallic, s.roughness)));
}

Surface unpack_surface(uvec4 bits) {
  vec3 root = vec3(bits.z & 1023u, bits.z >> 10 & 1023u, bits.z >> 20 & 1023u) / 1023.0;
  vec2 metal_rough = unpackUnorm2x16(bits.w);
  return Surface(from_octahedral(unpackSnorm2x16(bits.x)), from_octahedral(unpackSnorm2x16(bits.y)), root * root,
                 metal_rough.x, metal_rough.y);
}

#endif
