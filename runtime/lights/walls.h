// SPDX-License-Identifier: Apache-2.0
// Walls between lights: the metric of light clusters knows no geometry, and would let a cluster reach through one.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <unordered_map>

#include "lights/occupancy.h"
#include "rays/pack_rays.h"
#include "recipe_schema.h"

namespace chandelier::lights {

/// Something lies between that cannot be stepped around: on every one of eight detours, aside, straight on and back,
/// there is something too. Aside is half as far as the points are apart, so a wall covers 45 degrees as seen from
/// either.
bool wall_between(const rays::PackRays& rays, const glm::vec3& a_ws, const glm::vec3& b_ws);

/// Answers for pairs of a pack's lights, and remembers them for lights that do not move.
class Walls {
 public:
  /// What they refer to must outlive it.
  Walls(const pack::View& pack, const rays::PackRays& rays) : pack_(pack), rays_(rays) {}

  /// Neither may be directional. The same whichever comes first. Throws std::invalid_argument where a pack without
  /// voxels is asked for them.
  bool between(WallTest test, uint32_t light, uint32_t other);

 private:
  bool find(WallTest test, uint32_t light, uint32_t other);

  pack::View pack_;
  const rays::PackRays& rays_;
  std::optional<Occupancy> occupancy_;           // made when first asked for
  std::unordered_map<uint64_t, bool> known_[3];  // by WallTest; a pair is one number, the lower light above
};

}  // namespace chandelier::lights
