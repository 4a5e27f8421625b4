// SPDX-License-Identifier: Apache-2.0
// The select answer `error-driven`: which lights share a shadow map, by the error that this makes in what the camera
// sees.
#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <stop_token>
#include <utility>
#include <vector>

#include "lights/error_estimate.h"
#include "lights/light_samples.h"
#include "lights/map_candidates.h"

namespace chandelier {

/// Selections with ever fewer shadow maps, from one for each light or group down to as few as can be. Keeps what
/// changes from one to the next, so that its memory grows with the number of lights and not with its square.
class ErrorLadder {
 public:
  /// Samples must outlive this. Lights that keep a map of their own (lights::has_own_center) lend it to none.
  /// `group_centers`: of each light the one whose map its group shares, of a light in no group anything; needed where
  /// there are groups. Throws SearchStopped.
  ErrorLadder(const LightSamples& samples, DynamicLights dynamic_lights, std::span<const uint32_t> group_centers = {},
              const std::stop_token& stop = {});

  uint32_t fewest_maps() const { return rungs_.back().maps; }
  /// The best found with at most `maps` (or fewest_maps(), where that is more), by the error of hard shadows with each
  /// light in one map; then lights without a map of their own may take shares of several (share_out()).
  /// Throws SearchStopped.
  std::vector<MapMember> with_at_most(uint32_t maps, const std::stop_token& stop = {}) const;
  /// The fewest maps whose estimated_rmse() is at most `most_rmse`, looked for as if that never rose with their number;
  /// all maps where none are found. `judge` is of the same view and lights, but has
  /// other points than the ladder was made for, on which it does better than anywhere else. Throws SearchStopped.
  std::vector<MapMember> within(double most_rmse, const LightSamples& judge, const ShadowReading& reading,
                                const std::stop_token& stop = {}) const;

  /// Changes of lights that the ladder keeps, and candidates that the search for it remembered at its end.
  size_t entries() const { return entries_; }
  size_t candidate_entries() const { return candidate_entries_; }
  /// entries() never exceeds this for each light: where it would, every second rung is left out, from the top.
  static constexpr size_t most_entries_per_light = 64;

 private:
  struct Change {
    uint32_t light;
    uint32_t center;  // the light whose map it takes from now on
  };
  struct Rung {
    uint32_t maps;
    double error;                 // sum of squares, each light in one map
    std::vector<Change> changes;  // from the rung before, which has more maps
    size_t best;                  // of this rung and those with fewer maps the one with the least error
  };

  void add_rung(uint32_t maps, double error, std::span<const uint32_t> before, std::span<const uint32_t> now);
  void thin_out();
  void find_best();
  std::vector<uint32_t> centers_at(size_t rung) const;
  const std::vector<MapMember>& members(size_t rung, const std::stop_token& stop) const;

  const LightSamples& samples_;
  MapCandidates candidates_;
  std::vector<Rung> rungs_;  // ever fewer maps. The best's error never rises with more maps, but may where lights have
                             // shares: of the fewer maps these may gain more
  size_t entries_ = 0;
  size_t candidate_entries_ = 0;
  mutable std::map<size_t, std::vector<MapMember>> members_;  // of rungs that were asked for
};

}  // namespace chandelier
