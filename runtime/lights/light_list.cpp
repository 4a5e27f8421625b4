// SPDX-License-Identifier: Apache-2.0
// One shadow map per light (the reference), or per light cluster (LightCluster §3.1).
#include "lights/light_list.h"

#include <algorithm>
#include <numeric>

#include "lights/light_clusters.h"

namespace chandelier {
namespace {

bool is_directional(const pack::Light& light) {
  return light.type == pack::LightType::directional;
}

// LightCluster §3.1.2: bounding spheres against the view frustum.
std::vector<uint32_t> lights_in_view(std::span<const pack::Light> lights, const Camera& camera, float aspect) {
  const FrustumPlanes planes = frustum_planes(camera, aspect);
  std::vector<uint32_t> in_view;
  for (uint32_t i = 0; i < lights.size(); ++i)
    if (is_directional(lights[i]) || intersects(planes, lights[i].position_ws, lights[i].range_m)) in_view.push_back(i);
  return in_view;
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
          .cone_offset = spot ? -light.outer_cone_cos * scale : 1.0f};
}

// A light, and the light whose position its shadow map is drawn from.
struct Member {
  uint32_t light;
  uint32_t center;
  float map_range_m;
  float filter_radius_m;
};

std::vector<Member> members_of_light_clusters(std::span<const pack::Light> lights, std::span<const uint32_t> in_view,
                                              const Recipe& recipe, const Camera& camera) {
  std::vector<Member> members;
  std::vector<lights::ClusterLight> spheres;
  std::vector<uint32_t> numbers;
  for (uint32_t i : in_view) {
    if (is_directional(lights[i])) {
      members.push_back({i, i, 0.0f, 0.0f});
    } else {
      spheres.push_back({lights[i].position_ws, lights[i].range_m});
      numbers.push_back(i);
    }
  }
  const auto result = lights::select_light_clusters(spheres, {.camera_ws = camera.eye_ws,
                                                              .d_init_m = recipe.d_init_m,
                                                              .z_far_m = recipe.z_far_m,
                                                              .scaling = recipe.distance_scaling});
  for (uint32_t i = 0; i < numbers.size(); ++i) {
    const lights::LightCluster& joined = result.clusters[result.cluster_of_light[i]];
    members.push_back({numbers[i], numbers[joined.center], joined.range_m, joined.d_min_m});
  }
  return members;
}

std::vector<Member> one_map_each(std::span<const pack::Light> lights, std::span<const uint32_t> in_view) {
  std::vector<Member> members;
  for (uint32_t i : in_view) members.push_back({i, i, lights[i].range_m, 0.0f});
  return members;
}

}  // namespace

LightList select_lights(std::span<const pack::Light> lights, const Recipe& recipe, const Camera& camera, float aspect) {
  const auto in_view = lights_in_view(lights, camera, aspect);
  std::vector<Member> members = recipe.select == Select::light_clusters
                                    ? members_of_light_clusters(lights, in_view, recipe, camera)
                                    : one_map_each(lights, in_view);
  std::sort(members.begin(), members.end(), [](const Member& a, const Member& b) {
    return a.center != b.center ? a.center < b.center : a.light < b.light;
  });

  LightList list;
  for (size_t i = 0; i < members.size(); ++i) {
    const Member& member = members[i];
    if (i == 0 || members[i - 1].center != member.center) {
      list.maps.push_back({.center_ws = lights[member.center].position_ws,
                           .range_m = member.map_range_m,
                           .filter_radius_m = member.filter_radius_m,
                           .first_light = static_cast<uint32_t>(i),
                           .is_directional = is_directional(lights[member.center])});
    }
    list.lights.push_back(frame_light(lights[member.light]));
    list.lights.back().map = static_cast<uint32_t>(list.maps.size() - 1);
    ++list.maps.back().light_count;
    list.pack_light.push_back(member.light);
  }
  return list;
}

}  // namespace chandelier
