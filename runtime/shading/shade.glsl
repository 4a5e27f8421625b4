// SPDX-License-Identifier: Apache-2.0
// The light of one group's ShadowMaps on a surface. A lookup gives the same lights to all threads of a subgroup, since filters
// share taps among them. Expects what shading/group.glsl has in scope.
#ifndef CHANDELIER_SHADE_GLSL
#define CHANDELIER_SHADE_GLSL

// How much of map `number` reaches the receiver. `place` is what the including shader knows the surface by.
float visible_part(uint number, Receiver receiver, uvec2 place);

// KHR_lights_punctual, spot lights.
float cone_falloff(FrameLight light, vec3 to_light) {
  float cone = clamp(light.cone_offset - dot(light.direction_ws, to_light) * light.cone_scale, 0.0, 1.0);
  return cone * cone;
}

// Read once: where threads may be masked, as in a loop, Mesa 22 reads a buffer for each thread by itself.
vec3 eye_ws = view.eye_ws;

// A light's share at p, which is from the eye, before visibility. What is not asked of a light is not read: all threads ask alike for its type.
vec3 unshadowed(uint number, Reflector r, vec3 geometric_normal, vec3 p) {
  vec3 to_light;
  float falloff = 1.0;
  uint type = lights[number].type;
  if (type == LIGHT_TYPE_DIRECTIONAL) {
    to_light = -lights[number].direction_ws;
  } else {
    vec3 d = (lights[number].position_ws - eye_ws) - p;
    float distance2 = dot(d, d);
    float range_m = lights[number].range_m;
    to_light = d * inversesqrt(max(distance2, 1e-12));
    falloff = distance_falloff(distance2, range_m * range_m);
    if (type == LIGHT_TYPE_SPOT) falloff *= cone_falloff(lights[number], to_light);
  }
  float n_dot_l = dot(r.normal, to_light);
  bool reaches = falloff > 0.0 && n_dot_l > 0.0 && dot(geometric_normal, to_light) > 0.0;
  if (!reaches) return vec3(0.0);
  return lights[number].radiant * (falloff * n_dot_l) * reflected(r, to_light, n_dot_l);
}

// One light after the other, each with its own visibility.
vec3 lit_in_any_order(Surface s, Reflector r, Receiver receiver, vec3 p, uvec2 place) {
  vec3 sum = vec3(0.0);
  uint light = first_light();
  if (light < group.light_end) do {
    uint number = lights[light].map;
    vec3 of_light = unshadowed(light, r, s.geometric_normal, p);
    bool reached = subgroupAny(largest(of_light) > 0.0);
    if (number != NONE && reached) of_light *= visible_part(number, receiver, place);
    sum += of_light;
    light = light_after(light);
  } while (light < group.light_end);
  return sum;
}

// Where the lookup keeps order, lights that share a map follow each other, so that visibility is had once for each map.
// Loops run at least once and test at their end: a driver that masks lanes runs a `for`'s body once more than asked. It also
// executes what stands behind an `if` that no thread takes, which is why the inner loop goes on over maps of which nothing
// reaches these pixels: visibility is read once for each map that does.
vec3 lit_by_group(Surface s, vec3 p, uvec2 place) {
  Reflector r = reflector(s, normalize(-p));
  Receiver receiver = receiver_at(p, s.geometric_normal);
  if (!lookup_keeps_order()) return lit_in_any_order(s, r, receiver, p, place);
  vec3 sum = vec3(0.0);
  uint light = first_light();
  if (light < group.light_end) do {
    uint number;
    vec3 of_map;
    bool reached;
    do {
      number = lights[light].map;  // NONE: of this light and all after it
      uint map_end = number == NONE ? group.light_end : maps[number].first_light + maps[number].light_count;
      of_map = vec3(0.0);
      do {
        of_map += unshadowed(light, r, s.geometric_normal, p);
        light = light_after(light);
      } while (light < map_end);
      reached = number == NONE || subgroupAny(largest(of_map) > 0.0);
    } while (!reached && light < group.light_end);
    if (number != NONE && reached) of_map *= visible_part(number, receiver, place);
    sum += of_map;
  } while (light < group.light_end);
  return sum;
}

#endif
