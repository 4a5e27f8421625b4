// SPDX-License-Identifier: Apache-2.0
#include "lights/walls.h"

#include <cmath>
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

bool Walls::find(WallTest test, uint32_t light, uint32_t other) {
  const glm::vec3 &a_ws = pack_.lights[light].position_ws, &b_ws = pack_.lights[other].position_ws;
  if (test == WallTest::none) return false;
  if (test == WallTest::rays) return wall_between(rays_, a_ws, b_ws);
  if (!occupancy_) occupancy_.emplace(pack_);
  return occupancy_->between(a_ws, b_ws);
}

bool Walls::between(WallTest test, uint32_t light, uint32_t other) {
  if (light > other) std::swap(light, other);
  if (pack_.lights[light].dynamic || pack_.lights[other].dynamic) return find(test, light, other);
  auto& answers = known_[static_cast<size_t>(test)];
  const uint64_t pair = uint64_t{light} << 32 | other;
  const auto known = answers.find(pair);
  if (known != answers.end()) return known->second;
  return answers.emplace(pair, find(test, light, other)).first->second;
}

}  // namespace chandelier::lights
