// SPDX-License-Identifier: Apache-2.0
#include "world/nearest_caster.h"

#include <algorithm>
#include <cmath>

#include "light_near.h"
#include "throws_shadow.h"
#include "triangle_distance.h"
#include "world/world.h"

namespace chandelier {
namespace {

// From twice this distance on every near plane is the farthest there is.
constexpr float farthest_that_matters_m = 2.0f * pack::most_shadow_near_m / pack::shadow_near_per_distance;

double distance_to_box(const glm::dvec3& p, const pack::BatchInstance& draw) {
  return glm::length(p - glm::clamp(p, glm::dvec3(draw.bounds_min_ws), glm::dvec3(draw.bounds_max_ws)));
}

double distance_to_batch(const World& world, const pack::BatchInstance& draw, const glm::dvec3& at) {
  const pack::View& pack = world.pack();
  const pack::Batch& batch = pack.batches[draw.batch];
  const auto& rows = world.instances()[draw.instance].world_from_local;
  double nearest = INFINITY;
  for (uint32_t i = batch.first_index; i < batch.first_index + batch.index_count; i += 3) {
    pack::Triangle corners;
    for (uint32_t k = 0; k < 3; ++k) {
      const glm::dvec4 p(glm::dvec3(pack.positions[pack.indices[i + k].vertex].position_ls), 1.0);
      for (int axis = 0; axis < 3; ++axis) corners[k][axis] = glm::dot(glm::dvec4(rows[axis]), p) - at[axis];
    }
    nearest = std::min(nearest, pack::distance_to_triangle(corners));
  }
  return nearest;
}

}  // namespace

float nearest_caster_m(const World& world, const glm::vec3& at_ws, float most_m) {
  const glm::dvec3 at(at_ws);
  double nearest = std::min(most_m, farthest_that_matters_m);
  for (const pack::BatchInstance& draw : world.batch_instances())
    if (distance_to_box(at, draw) <= nearest && pack::throws_shadow(world.pack(), draw))
      nearest = std::min(nearest, distance_to_batch(world, draw, at));
  const auto rounded = static_cast<float>(nearest);
  return double{rounded} > nearest ? std::nextafter(rounded, 0.0f) : rounded;
}

}  // namespace chandelier
