// SPDX-License-Identifier: Apache-2.0
// Lights and cameras into their records.
#include "lights.h"

#include <algorithm>
#include <cfloat>
#include <cmath>

#include "light_bounds.h"
#include "voxel_grid.h"

namespace chandelier::baker {

float derived_range_m(float intensity_cd, const glm::vec3& color, float threshold_lx) {
  const double brightest_cd = double{intensity_cd} * std::max({color.r, color.g, color.b});
  return static_cast<float>(std::min(std::sqrt(brightest_cd / double{threshold_lx}), double{FLT_MAX}));
}

void make_lights(const Scene& scene, float range_threshold_lx, Strings& strings, pack::Contents& pack) {
  for (const Light& light : scene.lights) {
    pack::Light out;
    out.position_ws = light.position_ws;
    out.direction_ws = light.direction_ws;
    out.intensity = light.intensity;
    out.color = light.color;
    out.inner_cone_cos = 1;
    out.outer_cone_cos = -1;
    out.priority = light.priority;
    out.dynamic = light.dynamic || light.node != kNone;
    out.unclustered = light.unclustered;
    out.node = light.node;
    out.bounds_center_ws = light.position_ws;
    out.name = strings.add(light.name);
    if (light.type == LightType::directional) {
      out.type = pack::LightType::directional;
      out.range_source = pack::RangeSource::unbounded;
      pack.lights.push_back(out);
      continue;
    }
    out.type = light.type == LightType::spot ? pack::LightType::spot : pack::LightType::point;
    out.range_source = light.range_m ? pack::RangeSource::authored : pack::RangeSource::derived;
    out.range_m = light.range_m ? *light.range_m : derived_range_m(light.intensity, light.color, range_threshold_lx);
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
}

void make_cameras(const Scene& scene, Strings& strings, pack::Contents& pack) {
  for (const Camera& camera : scene.cameras) {
    pack.cameras.push_back({.position_ws = camera.position_ws,
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
