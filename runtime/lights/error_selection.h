// SPDX-License-Identifier: Apache-2.0
// The select answer `error-driven`: which lights share a shadow map, by the error that this makes in what the camera
// sees.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "lights/error_estimate.h"
#include "lights/light_samples.h"

namespace chandelier {

/// Selections with ever fewer shadow maps, from one for each light or group down to as few as can be.
class ErrorLadder {
 public:
  /// Samples must outlive this. Lights that keep a map of their own (lights::has_own_center) lend it to none.
  /// `group_centers`: of each light the one whose map its group shares, of a light in no group anything; needed where
  /// there are groups.
  ErrorLadder(const LightSamples& samples, DynamicLights dynamic_lights, std::span<const uint32_t> group_centers = {});

  uint32_t fewest_maps() const;
  /// The best found with at most `maps` (or fewest_maps(), where that is more), by the error of hard shadows with each
  /// light in one map; then lights without a map of their own may take shares of several (share_out()).
  std::vector<MapMember> with_at_most(uint32_t maps) const;
  /// The fewest maps whose estimated_rmse() is at most `most_rmse`, looked for as if that never rose with their number;
  /// all maps where none are found. `judge` is of the same view and lights, but has
  /// other points than the ladder was made for, on which it does better than anywhere else.
  std::vector<MapMember> within(double most_rmse, const LightSamples& judge, const ShadowReading& reading) const;

 private:
  struct Rung {
    std::vector<uint32_t> center;  // of each light
    double error;                  // sum of squares, each light in one map
  };
  const std::vector<MapMember>& members(size_t rung) const;

  const LightSamples& samples_;
  std::vector<std::vector<uint32_t>> lenders_;  // of each light those whose map it may take, nearest first
  uint32_t most_maps_ = 0;
  std::vector<Rung> rungs_;  // by the number of maps, one more each, from fewest_maps(); error never rises, but may
                             // where lights have shares: of the fewer maps these may gain more
  mutable std::vector<std::vector<MapMember>> members_;  // of each rung; empty until asked for
};

}  // namespace chandelier
