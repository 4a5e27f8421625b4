// SPDX-License-Identifier: Apache-2.0
// Keep this and the shaders beside it alike.
#include "shadows/cull/count_casters.h"

#include <array>
#include <glm/glm.hpp>

#include "throws_shadow.h"

namespace chandelier {
namespace {

// cull_light_frustum.comp:reaches
bool reaches(const frame::ShadowView& view, const pack::BatchInstance& candidate) {
  const glm::vec3 nearest = glm::clamp(view.center_ws, candidate.bounds_min_ws, candidate.bounds_max_ws);
  const glm::vec3 d = nearest - view.center_ws;
  return view.range_m == 0.0f || glm::dot(d, d) <= view.range_m * view.range_m;
}

// cull_light_frustum.comp:inside
bool inside(const glm::vec4& plane, const glm::vec3& low, const glm::vec3& high) {
  const glm::vec3 corner = glm::mix(low, high, glm::greaterThan(glm::vec3(plane), glm::vec3(0.0f)));
  return glm::dot(glm::vec3(plane), corner) + plane.w >= 0.0f;
}

std::array<glm::vec4, 6> planes_of(const frame::ShadowView& view) {
  const auto& c = view.clip_from_center;
  const glm::mat4 rows = glm::transpose(glm::mat4(c[0], c[1], c[2], c[3]));
  return {rows[3] + rows[0], rows[3] - rows[0], rows[3] + rows[1], rows[3] - rows[1], rows[3] - rows[2], rows[2]};
}

bool survives(const frame::ShadowView& view, const std::array<glm::vec4, 6>& planes,
              const pack::BatchInstance& candidate) {
  if (!reaches(view, candidate)) return false;
  const glm::vec3 low = candidate.bounds_min_ws - view.center_ws, high = candidate.bounds_max_ws - view.center_ws;
  for (const glm::vec4& plane : planes)
    if (!inside(plane, low, high)) return false;
  return true;
}

}  // namespace

CasterCounts count_casters(Cull cull, std::span<const frame::ShadowView> views, const World& world) {
  const pack::View& pack = world.pack();
  CasterCounts counts;
  for (const frame::ShadowView& view : views) {
    const auto planes = planes_of(view);
    for (const pack::BatchInstance& candidate : world.batch_instances()) {
      if (!pack::throws_shadow(pack, candidate)) continue;
      if (cull == Cull::light_frustum && !survives(view, planes, candidate)) continue;
      ++counts.draws;
      counts.triangles += pack.batches[candidate.batch].index_count / 3;
    }
  }
  return counts;
}

}  // namespace chandelier
