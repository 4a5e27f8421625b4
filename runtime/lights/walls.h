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
#include "world/world.h"

namespace chandelier::lights {

/// Something lies between that cannot be stepped around: on every one of eight detours, aside, straight on and back,
/// there is something too. Aside is half as far as the points are apart, so a wall covers 45 degrees as seen from
/// either.
bool wall_between(const rays::PackRays& rays, const glm::vec3& a_ws, const glm::vec3& b_ws);

/// Answers for pairs of a world's lights, and remembers them until one of the two or an instance changes.
class Walls {
 public:
  /// Both must outlive it. `rays` must stand as the world does.
  Walls(const World& world, const rays::PackRays& rays) : world_(world), rays_(rays) {}

  /// Neither may be directional. The same whichever comes first. Throws std::invalid_argument where a pack without
  /// voxels is asked for them, or one of whose instances in voxels has moved, which voxels do not follow.
  bool between(WallTest test, LightId light, LightId other);

 private:
  struct Known {
    Version light;
    Version other;
    bool is_blocked;
  };
  bool find(WallTest test, LightId light, LightId other);
  void refuse_moved_voxels() const;

  const World& world_;
  const rays::PackRays& rays_;
  std::optional<Occupancy> occupancy_;            // made when first asked for
  Version instances_ = 0;                         // that known_ is of
  std::unordered_map<uint64_t, Known> known_[3];  // by WallTest; a pair is one number, the lower light above
};

}  // namespace chandelier::lights
