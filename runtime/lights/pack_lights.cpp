// SPDX-License-Identifier: Apache-2.0
#include "lights/pack_lights.h"

#include <algorithm>

namespace chandelier {
std::vector<LightId> lights_in_view(const World& world, const Camera& camera, float aspect, bool out_of_view) {
  const FrustumPlanes planes = frustum_planes(camera, aspect);
  std::vector<LightId> in_view;
  for (LightId id = 0; id < world.lights().size(); ++id) {
    const pack::Light& light = world.lights()[id];
    if (world.has_light(id) &&
        (out_of_view || is_directional(light) || intersects(planes, light.position_ws, light.range_m)))
      in_view.push_back(id);
  }
  return in_view;
}

std::vector<LightId> take_shadowless(const World& world, std::vector<LightId>& ids) {
  const auto end =
      std::stable_partition(ids.begin(), ids.end(), [&](LightId id) { return world.lights()[id].shadowless == 0; });
  const std::vector<LightId> shadowless(end, ids.end());
  ids.erase(end, ids.end());
  return shadowless;
}

frame::FrameLight frame_light(const pack::Light& light) {
  // KHR_lights_punctual, spot lights: the cone's falloff as one multiply and add.
  const bool spot = light.type == pack::LightType::spot;
  const float scale = spot ? 1.0f / std::max(0.001f, light.inner_cone_cos - light.outer_cone_cos) : 0.0f;
  return {.position_ws = light.position_ws,
          .range_m = light.range_m,
          .direction_ws = light.direction_ws,
          .type = static_cast<uint32_t>(light.type),
          .radiant = light.color * light.intensity,
          .cone_scale = scale,
          .cone_offset = spot ? -light.outer_cone_cos * scale : 1.0f,
          .map = pack::none};
}

float source_radius_m(const pack::Light& light, float z_far_m) {
  return is_directional(light) ? light.radius_m * z_far_m : light.radius_m;
}

lights::ClusterLight cluster_light(const pack::Light& light) {
  return {.position_ws = light.position_ws,
          .range_m = light.range_m,
          .axis_ws = light.direction_ws,
          .cone_cos = light.type == pack::LightType::spot ? light.outer_cone_cos : -1.0f,
          .dynamic = light.dynamic != 0,
          .unclustered = light.unclustered != 0,
          .group = light.group,
          .priority = light.priority};
}

lights::ClusterLight far_cluster_light(const pack::Light& light, float z_far_m) {
  lights::ClusterLight far = cluster_light(light);
  far.position_ws = -z_far_m * light.direction_ws;
  far.range_m = light.intensity * glm::dot(light.color, glm::vec3(0.2126f, 0.7152f, 0.0722f));
  return far;
}

lights::ClusterSettings cluster_settings(const Recipe& recipe, const Camera& camera) {
  return {.camera_ws = camera.eye_ws,
          .d_init_m = recipe.d_init_m,
          .z_far_m = recipe.z_far_m,
          .scaling = recipe.distance_scaling,
          .dynamic_lights = recipe.dynamic_lights,
          .stability = recipe.stability};
}

}  // namespace chandelier
