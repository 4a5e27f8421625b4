// SPDX-License-Identifier: Apache-2.0
// How many maps the select stage would make.
#pragma once

#include <vector>

#include "lights/cluster_counter.h"
#include "recipe_schema.h"
#include "view/camera.h"
#include "world/world.h"

namespace chandelier {

/// Counts the maps that select_lights() makes of the same input, for one d_init after another, in less time than a
/// list takes. For light clusters without walls, held or previous centres.
class MapCounter {
 public:
  MapCounter(const World& world, const Recipe& recipe, const Camera& camera, float aspect, bool out_of_view);

  size_t in_view() const { return in_view_; }  // lights that throw a shadow
  bool group_shares() const { return group_shares_; }
  /// Any number above `most` where there are more.
  size_t count(float d_init_m, size_t most);
  /// No later d_init will be larger, which makes counting faster.
  void stay_within(float d_init_m);

 private:
  std::vector<lights::ClusterCounter> counters_;  // of directional lights, and of others
  size_t in_view_ = 0;
  bool group_shares_ = false;
};

}  // namespace chandelier
