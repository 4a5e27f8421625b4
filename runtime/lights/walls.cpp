// SPDX-License-Identifier: Apache-2.0
#include "lights/walls.h"

#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>

namespace chandelier::lights {
namespace {

constexpr float aside_per_distance = 0.5f;
constexpr int detours = 8;

}  // namespace

bool wall_between(const rays::PackRays& rays, const glm::vec3& a_ws, const glm::vec3& b_ws) {
  if (!rays.blocked(a_ws, b_ws)) return false;
  const float distance_m = glm::distance(a_ws, b_ws);
  const glm::vec3 way = (b_ws - a_ws) / distance_m;
  const glm::vec3 u = glm::normalize(glm::cross(way, std::abs(way.x) < 0.5f ? glm::vec3(1, 0, 0) : glm::vec3(0, 1, 0)));
  const glm::vec3 v = glm::cross(way, u);
  for (int i = 0; i < detours; ++i) {
    const float angle = 2.0f * std::acos(-1.0f) * static_cast<float>(i) / detours;
    const glm::vec3 aside = aside_per_distance * distance_m * (std::cos(angle) * u + std::sin(angle) * v);
    if (!rays.blocked(a_ws, a_ws + aside) && !rays.blocked(a_ws + aside, b_ws + aside) &&
        !rays.blocked(b_ws + aside, b_ws))
      return false;
  }
  return true;
}

// What an animation moves is in no voxel.
void Walls::refuse_moved_voxels() const {
  for (const InstanceId id : world_.instances_changed_since(0))
    if (world_.instances()[id].dynamic == 0)
      throw std::invalid_argument("walls voxels: instance " + std::to_string(id) +
                                  " has moved, and the pack's voxels do not follow; use walls rays");
}

bool Walls::find(WallTest test, LightId light, LightId other) {
  const glm::vec3 &a_ws = world_.lights()[light].position_ws, &b_ws = world_.lights()[other].position_ws;
  if (test == WallTest::none) return false;
  if (test == WallTest::rays) return wall_between(rays_, a_ws, b_ws);
  refuse_moved_voxels();
  if (!occupancy_) occupancy_.emplace(world_.pack());
  return occupancy_->between(a_ws, b_ws);
}

bool Walls::between(WallTest test, LightId light, LightId other) {
  if (light > other) std::swap(light, other);
  if (std::exchange(instances_, world_.instances_version()) != world_.instances_version())
    for (auto& answers : known_) answers.clear();
  const Version version = world_.light_version(light), other_version = world_.light_version(other);
  auto& answers = known_[static_cast<size_t>(test)];
  const uint64_t pair = uint64_t{light} << 32 | other;
  const auto known = answers.find(pair);
  if (known != answers.end() && known->second.light == version && known->second.other == other_version)
    return known->second.is_blocked;
  const bool is_blocked = find(test, light, other);
  answers.insert_or_assign(pair, Known{version, other_version, is_blocked});
  return is_blocked;
}

}  // namespace chandelier::lights
