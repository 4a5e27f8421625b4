// SPDX-License-Identifier: Apache-2.0
// The g-buffer's surfaces, and the radiance that no shadow takes away: emission, ambient, and a headlight, which shines
// from the eye on all that is seen and is as bright at any distance. Its alpha keeps the material's occlusion for later passes, or
// says that the colour is what the screen shall show (KHR_materials_unlit): neither light nor exposure changes it.
#include "frame_schema.glsl"
#include "pack_schema.glsl"
#include "shading/ambient.glsl"
#include "shading/material.glsl"
#include "shading/occlusion.glsl"
#include "shading/surface.glsl"

layout(binding = 0, scalar) readonly buffer Views { ViewConstants view; };
layout(binding = 3, scalar) readonly buffer Materials { Material materials[]; };

layout(location = 0) in vec3 position_from_eye;
layout(location = 1) in vec3 normal_ws;
layout(location = 2) in vec4 tangent_ws;
layout(location = 3) in vec2 uv[5];
layout(location = 8) in vec4 color;
layout(location = 9) flat in uint material_number;

layout(location = 0) out uvec4 surface_bits;
layout(location = 1) out vec4 radiance;

// glTF: tangent space with x along the tangent, y along cross(normal, tangent) * w.
vec3 bent_normal(Material m, vec3 n) {
  vec3 t = tangent_ws.xyz - n * dot(n, tangent_ws.xyz);
  if (m.normal_texture == NONE || dot(t, t) < 1e-12) return n;
  t = normalize(t);
  vec3 sampled = unit_normal(texture(normal_map, uv[2]).xy);
  sampled.xy *= m.normal_scale;
  return normalize(sampled.x * t + sampled.y * cross(n, t) * tangent_ws.w + sampled.z * n);
}

#ifdef MULTISAMPLED
layout(location = 2) out float middle_depth;  // in the middle of the pixel; the depth that each sample has is that at the sample

// The samples that a material with holes covers: as many as its alpha says, going from none to all within one pixel about
// the cutoff.
int covered_samples(float alpha, float cutoff) {
  float share = clamp((alpha - cutoff) / max(fwidth(alpha), 1e-4) + 0.5, 0.0, 1.0);
  return (1 << int(share * float(samples) + 0.5)) - 1;
}
#endif

const float LEAST_DEPTH = 1e-30;  // of what is not the background

void main() {
  Material m = materials[material_number];
  vec4 base = m.base_color_factor * color * texture(base_color_map, uv[0]);

  vec3 facet = cross(dFdx(position_from_eye), dFdy(position_from_eye));
  facet = dot(facet, position_from_eye) > 0.0 ? -facet : facet;
  vec3 n = dot(normal_ws, normal_ws) > 0.0 ? normalize(normal_ws) : vec3(0.0, 1.0, 0.0);
  facet = dot(facet, facet) > 0.0 ? normalize(facet) : n;
  vec3 bent = bent_normal(m, n);
  if (!gl_FrontFacing) bent = -bent;

  vec2 metal_rough = vec2(m.metallic_factor, m.roughness_factor);
  if (m.metallic_roughness_texture != NONE) metal_rough *= texture(metallic_roughness_map, uv[1]).bg;
  vec3 emissive = m.emissive;
  if (m.emissive_texture != NONE) emissive *= texture(emissive_map, uv[4]).rgb;
  float occlusion = 1.0;
  if (m.occlusion_texture != NONE)
    occlusion += m.occlusion_strength * (min(texture(occlusion_map, uv[3]).r, 1.0) - 1.0);

  // Last: derivatives are undefined beside a pixel that has ended.
#ifdef MULTISAMPLED
  gl_SampleMask[0] = m.alpha_mode == ALPHA_MODE_MASK ? covered_samples(base.a, m.alpha_cutoff) : -1;
  // Beyond the horizon of a plane that is seen edge on, its depth in the middle of the pixel is below 0, which stands for the
  // background.
  middle_depth = max(gl_FragCoord.z, LEAST_DEPTH);
#else
  if (m.alpha_mode == ALPHA_MODE_MASK && base.a < m.alpha_cutoff) discard;
#endif
  surface_bits = pack_surface(Surface(bent, facet, base.rgb, metal_rough.x, metal_rough.y));
  float facing = max(-dot(bent, normalize(position_from_eye)), 0.0);
  vec3 reflected = ambient_at(view.ambient, bent) * occlusion + view.headlight * facing;
  radiance = m.unlit != 0u ? vec4(base.rgb, UNLIT_ALPHA)
                           : vec4(emissive + reflected * min(base.rgb, 1.0), alpha_of_occlusion(occlusion));
}
