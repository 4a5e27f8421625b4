// SPDX-License-Identifier: Apache-2.0
// Adds the light of one round's ShadowMaps to the picture. Lookup `all`: every light is tested against every pixel;
// delivery `inline`: visibility is read here, once per shadow map and pixel, for all the lights that share the map.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "frame_schema.glsl"
#include "pack_schema.glsl"
#include "shading/brdf.glsl"

layout(constant_id = 0) const uint filter_answer = 0u;
layout(constant_id = 1) const uint shade_answer = 0u;
const uint FILTER_HARD = 0u, FILTER_PCF = 1u;  // frame/recipe.h
const uint SHADE_GGX = 0u, SHADE_LAMBERT = 1u;

layout(local_size_x = 8, local_size_y = 8) in;
layout(binding = 0, scalar) readonly buffer View { ViewConstants view; };
layout(binding = 1, scalar) readonly buffer Lights { FrameLight lights[]; };
layout(binding = 2, scalar) readonly buffer Maps { ShadowMap maps[]; };
layout(binding = 3, scalar) readonly buffer Views { ShadowView views[]; };
layout(binding = 4) uniform usampler2D surface_image;
layout(binding = 5) uniform sampler2D depth_image;
layout(binding = 6) uniform samplerCubeArrayShadow cubes;
layout(binding = 7) uniform sampler2DArrayShadow layers;
layout(binding = 8, rgba32f) uniform image2D radiance_image;
layout(push_constant, scalar) uniform Push { ShadeConstants round; };

#include "shadows/filter/hard.glsl"
#include "shadows/filter/pcf.glsl"

float visibility(ShadowMap map, vec3 p, vec3 n, vec2 pixel) {
  if (filter_answer == FILTER_PCF) return pcf_visibility(map, p, n, pixel);
  return hard_visibility(map, p, n);
}

// What arrives at p and from where; zero where the light does not reach.
struct Incoming {
  vec3 illuminance;
  vec3 to_light;
};

Incoming incoming(FrameLight light, vec3 p) {
  if (light.type == LIGHT_TYPE_DIRECTIONAL) return Incoming(light.radiant, -light.direction_ws);
  vec3 d = light.position_ws - p;
  float distance_m = length(d);
  vec3 to_light = d / max(distance_m, 1e-6);
  float cone = clamp(dot(light.direction_ws, -to_light) * light.cone_scale + light.cone_offset, 0.0, 1.0);
  return Incoming(light.radiant * (distance_falloff(distance_m, light.range_m) * cone * cone), to_light);
}

vec3 reflected(Surface s, vec3 to_eye, vec3 to_light, float n_dot_l) {
  return shade_answer == SHADE_LAMBERT ? lambert(s) : ggx(s, to_eye, to_light, n_dot_l);
}

vec3 world_position(ivec2 pixel, float depth) {
  vec2 clip = (vec2(pixel) + 0.5) / view.size_px * 2.0 - 1.0;
  vec4 p = mat4(view.world_from_clip[0], view.world_from_clip[1], view.world_from_clip[2], view.world_from_clip[3]) *
           vec4(clip, depth, 1.0);
  return p.xyz / p.w;
}

// The light of one map's lights at p, before visibility.
vec3 unshadowed(ShadowMap map, Surface s, vec3 p, vec3 to_eye) {
  vec3 sum = vec3(0.0);
  uint i = map.first_light;
  do {
    Incoming light_in = incoming(lights[i], p);
    float n_dot_l = dot(s.normal, light_in.to_light);
    bool reaches = largest(light_in.illuminance) > 0.0 && n_dot_l > 0.0 && dot(s.geometric_normal, light_in.to_light) > 0.0;
    if (reaches) sum += light_in.illuminance * n_dot_l * reflected(s, to_eye, light_in.to_light, n_dot_l);
  } while (++i < map.first_light + map.light_count);
  return sum;
}

// Loops run at least once and test at their end: a driver that masks lanes runs a `for`'s body once more than asked.
vec3 lit_by_round(Surface s, vec3 p, vec2 pixel) {
  vec3 to_eye = normalize(view.eye_ws - p);
  vec3 sum = vec3(0.0);
  uint i = round.first_map;
  do {
    ShadowMap map = maps[i];
    bool in_range = map.is_directional != 0u || distance(p, map.center_ws) < map.range_m;  // LightCluster §3.2.2: C_att
    if (in_range) {
      vec3 light = unshadowed(map, s, p, to_eye);
      if (largest(light) > 0.0) sum += visibility(map, p, s.geometric_normal, pixel) * light;
    }
  } while (++i < round.first_map + round.map_count);
  return sum;
}

void main() {
  ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  if (any(greaterThanEqual(vec2(pixel), view.size_px))) return;
  float depth = texelFetch(depth_image, pixel, 0).r;
  vec4 radiance = imageLoad(radiance_image, pixel);
  bool unlit = radiance.a == 0.0;
  if (depth == 0.0 || unlit || round.map_count == 0u) return;
  Surface s = unpack_surface(texelFetch(surface_image, pixel, 0));
  vec3 p = world_position(pixel, depth);
  imageStore(radiance_image, pixel, vec4(radiance.rgb + lit_by_round(s, p, vec2(pixel)), radiance.a));
}
