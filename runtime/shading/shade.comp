// SPDX-License-Identifier: Apache-2.0
// Adds the light of one round's ShadowMaps to the picture. Lights that share a map follow each other, so that visibility
// is had once per map and pixel: delivery `inline` filters it here, `textures` reads what visibility.comp left.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shading/round.glsl"
#include "shading/brdf.glsl"

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

// A light's share at p, before visibility.
vec3 unshadowed(FrameLight light, Surface s, vec3 p, vec3 to_eye) {
  Incoming light_in = incoming(light, p);
  float n_dot_l = dot(s.normal, light_in.to_light);
  bool reaches = largest(light_in.illuminance) > 0.0 && n_dot_l > 0.0 && dot(s.geometric_normal, light_in.to_light) > 0.0;
  if (!reaches) return vec3(0.0);
  return light_in.illuminance * n_dot_l * reflected(s, to_eye, light_in.to_light, n_dot_l);
}

float delivered_visibility(ShadowMap map, vec3 p, vec3 n, uvec2 pixel) {
  if (deliver_answer == DELIVER_INLINE) return visibility(map, p, n, vec2(pixel));
  uint place = visibility_place(map, pixel);
  return place != NONE && in_range(map, p) ? float(uint(visibility_bytes[place])) / 255.0 : 0.0;
}

// Loops run at least once and test at their end: a driver that masks lanes runs a `for`'s body once more than asked.
vec3 lit_by_round(Surface s, vec3 p, uvec2 pixel) {
  vec3 to_eye = normalize(view.eye_ws - p);
  vec3 sum = vec3(0.0);
  uint light = next_light(round.first_light);
  if (light < round.light_end) do {
    ShadowMap map = maps[lights[light].map];
    uint map_end = map.first_light + map.light_count;
    vec3 of_map = vec3(0.0);
    do {
      of_map += unshadowed(lights[light], s, p, to_eye);
      light = next_light(light + 1u);
    } while (light < map_end);
    if (largest(of_map) > 0.0) sum += delivered_visibility(map, p, s.geometric_normal, pixel) * of_map;
  } while (light < round.light_end);
  return sum;
}

void main() {
  ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  if (any(greaterThanEqual(vec2(pixel), view.size_px))) return;
  float depth = texelFetch(depth_image, pixel, 0).r;
  vec4 radiance = imageLoad(radiance_image, pixel);
  bool unlit = radiance.a == 0.0;
  if (depth == 0.0 || unlit || round.first_light == round.light_end) return;
  Surface s = unpack_surface(texelFetch(surface_image, pixel, 0));
  vec3 p = world_position(view, vec2(pixel) + 0.5, depth);
  imageStore(radiance_image, pixel, vec4(radiance.rgb + lit_by_round(s, p, uvec2(pixel)), radiance.a));
}
