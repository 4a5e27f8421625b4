// SPDX-License-Identifier: Apache-2.0
// Lights and cameras into their records.
#include "lights.h"

#include <tbb/parallel_for.h>

#include <cmath>
#include <string>
#include <unordered_map>

#include "light_bounds.h"
#include "light_range.h"
#include "light_rays.h"
#include "voxel_grid.h"

namespace chandelier::baker {

namespace {

/// Numbers from 1, in the order in which the names occur; 0 for no name.
class Groups {
 public:
  uint32_t number(const std::string& name) {
    if (name.empty()) return 0;
    return numbers_.try_emplace(name, static_cast<uint32_t>(numbers_.size() + 1)).first->second;
  }

 private:
  std::unordered_map<std::string, uint32_t> numbers_;
};

/// Rounds down, so that no caster is nearer.
void measure_nearest(const pack::Contents& pack, const std::vector<uint32_t>& moving, pack::Light& light) {
  if (light.type == pack::LightType::directional) return;
  const double nearest = nearest_caster_m(pack, moving, glm::dvec3(light.position_ws), light.range_m);
  light.nearest_caster_m = static_cast<float>(nearest);
  if (double{light.nearest_caster_m} > nearest) light.nearest_caster_m = std::nextafter(light.nearest_caster_m, 0.0f);
}

}  // namespace

void make_lights(const Scene& scene, float range_threshold_lx, Strings& strings, pack::Contents& pack) {
  Groups groups;
  for (const Light& light : scene.lights) {
    pack::Light out;
    out.position_ws = glm::vec3(light.position_ws);
    out.direction_ws = light.direction_ws;
    out.intensity = light.intensity;
    out.color = light.color;
    out.inner_cone_cos = 1;
    out.outer_cone_cos = -1;
    out.priority = light.priority;
    out.dynamic = light.dynamic || light.node != no_index;
    out.unclustered = light.unclustered;
    out.shadowless = light.shadowless;
    out.radius_m = light.radius_m;
    out.group = groups.number(light.group);
    out.node = light.node;
    out.bounds_center_ws = out.position_ws;
    out.name = strings.add(light.name);
    if (light.type == LightType::directional) {
      out.type = pack::LightType::directional;
      out.range_source = pack::RangeSource::unbounded;
      pack.lights.push_back(out);
      continue;
    }
    out.type = light.type == LightType::spot ? pack::LightType::spot : pack::LightType::point;
    out.range_source = light.range_m ? pack::RangeSource::authored : pack::RangeSource::derived;
    out.range_m =
        light.range_m ? *light.range_m : pack::derived_range_m(light.intensity, light.color, range_threshold_lx);
    if (light.type == LightType::spot) {
      out.inner_cone_cos = std::cos(light.inner_cone_rad);
      out.outer_cone_cos = std::cos(light.outer_cone_rad);
    }
    const FloatSphere bounds = rounded_outwards(light_bounds(out));
    out.bounds_center_ws = bounds.center;
    out.bounds_radius_m = bounds.radius;
    if (!pack.voxel_grid.empty()) out.voxel = cell_at(pack.voxel_grid[0], out.position_ws);
    pack.lights.push_back(out);
  }
  const std::vector<uint32_t> moving = moving_batch_instances(pack);
  tbb::parallel_for(size_t{0}, pack.lights.size(), [&](size_t i) { measure_nearest(pack, moving, pack.lights[i]); });
}

void make_cameras(const Scene& scene, Strings& strings, pack::Contents& pack) {
  for (const Camera& camera : scene.cameras) {
    pack.cameras.push_back({.position_ws = glm::vec3(camera.position_ws),
                            .yfov_rad = camera.yfov_rad,
                            .forward_ws = camera.forward_ws,
                            .aspect = camera.aspect,
                            .up_ws = camera.up_ws,
                            .znear_m = camera.znear_m,
                            .node = camera.node,
                            .name = strings.add(camera.name)});
  }
}

}  // namespace chandelier::baker
