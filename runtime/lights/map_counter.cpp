// SPDX-License-Identifier: Apache-2.0
#include "lights/map_counter.h"

#include <algorithm>

#include "lights/pack_lights.h"

namespace chandelier {

MapCounter::MapCounter(const World& world, const Recipe& recipe, const Camera& camera, float aspect, bool out_of_view) {
  const auto lights = world.lights();
  std::vector<lights::ClusterLight> near, far;
  std::vector<uint64_t> groups;  // of the two kinds
  for (const uint32_t i : lights_in_view(world, camera, aspect, out_of_view)) {
    if (lights[i].shadowless != 0) continue;
    const bool directional = is_directional(lights[i]);
    (directional ? far : near)
        .push_back(directional ? far_cluster_light(lights[i], recipe.z_far_m) : cluster_light(lights[i]));
    if (lights[i].group != 0) groups.push_back(uint64_t{directional} << 32 | lights[i].group);
  }
  std::sort(groups.begin(), groups.end());
  group_shares_ = std::adjacent_find(groups.begin(), groups.end()) != groups.end();
  in_view_ = near.size() + far.size();
  lights::ClusterSettings settings = cluster_settings(recipe, camera);
  counters_.emplace_back(near, settings);
  settings.scaling = DistanceScaling::none;
  counters_.emplace_back(far, settings);
}

size_t MapCounter::count(float d_init_m, size_t most) {
  size_t maps = 0;
  for (lights::ClusterCounter& counter : counters_) maps += counter.count(d_init_m, most);
  return maps;
}

void MapCounter::stay_within(float d_init_m) {
  for (lights::ClusterCounter& counter : counters_) counter.stay_within(d_init_m);
}

}  // namespace chandelier
