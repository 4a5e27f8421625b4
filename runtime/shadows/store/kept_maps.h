// SPDX-License-Identifier: Apache-2.0
// Where the shadow maps of a frame lie in the pool of cubes, and which of them are there already. Needs no device.
#pragma once

#include <array>
#include <optional>
#include <span>
#include <unordered_map>
#include <vector>

#include "lights/light_list.h"
#include "shadows/store/cube_places.h"
#include "shadows/store/map_groups.h"
#include "world/world.h"

namespace chandelier {

/// All that a map's depths depend on. Two maps of equal contents have equal depths.
struct MapContents {
  LightId center = 0;         // whose place it is drawn from
  Version light_version = 0;  // of that light
  Version instances_version = 0;
  Cull cull{};                               // what is drawn beyond a light's range depends on it
  std::array<frame::ShadowView, 6> views{};  // as projected: `layer` is a face number, the place is 0
};

class KeptMaps {
 public:
  KeptMaps() : KeptMaps(1, 0) {}
  KeptMaps(uint32_t layer_size_px, uint32_t cubes);

  /// Gives every map of a group, and its views, a place. A map that lies in the pool with the same contents stays where
  /// it is and has `is_kept`; the others take what is free, or what was used longest ago. The group's maps must fit
  /// (plan_groups()). Whoever calls draws those that are not kept before the next group is placed.
  void place(const MapGroup& group, const World& world, Cull cull, LightList& list,
             std::vector<frame::ShadowView>& views);
  /// Nothing that lies in the pool is what it was.
  void forget();

 private:
  struct Entry {
    MapContents contents;
    CubePlace place;
    uint64_t last_use;
  };
  using Entries = std::unordered_multimap<LightId, Entry>;
  std::optional<CubePlace> find(const MapContents& contents);
  std::optional<CubePlace> take(uint32_t size_px);
  bool take_others(std::span<const frame::ShadowMap> maps);

  uint32_t layer_size_px_;
  uint32_t cubes_;
  CubePlaces free_;
  Entries entries_;
  uint64_t now_ = 0;  // groups placed
  // Of the group that is being placed; kept, so that a steady frame allocates nothing.
  std::vector<MapContents> contents_;
  std::vector<std::optional<CubePlace>> places_;
};

}  // namespace chandelier
