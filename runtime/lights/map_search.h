// SPDX-License-Identifier: Apache-2.0
// Which light takes which shadow map, as maps are taken away one by one: each time the one whose loss raises the error
// of what the camera sees least.
#pragma once

#include <cstdint>
#include <functional>
#include <queue>
#include <span>
#include <stop_token>
#include <utility>
#include <vector>

#include "lights/light_samples.h"
#include "lights/map_candidates.h"
#include "lights/pack_lights.h"
#include "lights/shown_curve.h"

namespace chandelier {

/// An assignment of lights to centres, and the picture that it makes: one luminance for each point. Takes memory in
/// proportion to lights, points, and what lights add to points.
class MapSearch {
 public:
  /// Of how many nearest centres a light tries each.
  static constexpr uint32_t most_candidates = 16;

  /// One map for each light or group. Samples and candidates must outlive this. `group_centers` as ErrorLadder has it.
  /// This and what changes it throws SearchStopped.
  MapSearch(const LightSamples& samples, const MapCandidates& candidates, std::span<const uint32_t> group_centers,
            const std::stop_token& stop);

  uint32_t map_count() const { return map_count_; }
  double error() const { return error_; }  // sum of squares
  const std::vector<uint32_t>& centers() const { return center_; }
  /// What it remembers of candidates, for all lights together.
  size_t candidate_entries() const;

  /// Takes away the centre whose loss raises the error least; false where none can go.
  bool drop_one();
  /// Each light to its best centre, again and again.
  void settle();
  /// Puts other centres in the place of present ones as long as that lowers the error. For a handful of maps.
  void exchange();

  /// Below this number of maps each matters enough for exchange().
  static constexpr uint32_t exchange_below = 8;

 private:
  struct Contribution {
    uint32_t point;
    float luminance;
  };
  struct Saved {
    std::vector<uint32_t> center;
    std::vector<bool> is_center;
    std::vector<float> luminance;
    std::vector<float> error_at;
    std::vector<uint32_t> changed_at;
    double error;
    uint32_t map_count;
  };
  // The nearest centres when it was filled. Until it is filled again centres may go, but none may come.
  struct Nearest {
    std::vector<uint32_t> centers;
    bool is_filled = false;
    bool is_all = false;  // no other centre can be taken
  };
  // A light's best move when settle() last looked, and what that depended on.
  struct Known {
    std::vector<uint32_t> candidates;
    uint32_t from = 0;
    uint32_t to = 0;
    double change = 0.0;
    uint32_t looked_at = 0;  // on the clock of changes; 0: not known
  };

  void join_groups(std::span<const uint32_t> group_centers);
  bool is_grouped(uint32_t light) const { return samples_.light(light).group != 0; }
  void count_costs();
  void list_centers();
  void find_candidates(uint32_t light);
  double change(uint32_t light, uint32_t from, uint32_t to) const;
  void move(uint32_t light, uint32_t to);
  std::pair<double, uint32_t> best_move(uint32_t light);
  std::pair<double, uint32_t> known_best_move(uint32_t light);
  bool drop(uint32_t center);
  void add(uint32_t center);
  double drop_cost(uint32_t center);
  uint32_t cheapest_but(uint32_t keep);
  Saved save() const { return {center_, is_center_, luminance_, error_at_, changed_at_, error_, map_count_}; }
  void restore(const Saved& saved);

  const LightSamples& samples_;
  const MapCandidates& candidates_;
  std::stop_token stop_;
  ShownCurve shown_;
  std::vector<std::vector<Contribution>> contributions_;
  std::vector<float> reference_;  // shown, of each point
  std::vector<uint32_t> center_;  // of each light
  std::vector<bool> is_center_;
  std::vector<float> luminance_;  // of each point, as the maps have it
  std::vector<float> error_at_;   // of each point, squared
  double error_ = 0.0;
  uint32_t map_count_;
  std::vector<uint32_t> listed_;      // centres when drop_one() or exchange() last ended
  std::vector<Nearest> nearest_;      // of each light among them
  std::vector<uint32_t> found_;       // by find_candidates()
  std::vector<Known> known_;          // of each light
  std::vector<uint32_t> changed_at_;  // of each point, when its luminance last changed
  uint32_t clock_ = 0;                // counts moves
  using Cost = std::pair<double, uint32_t>;
  std::priority_queue<Cost, std::vector<Cost>, std::greater<>> costs_;  // of dropping a centre, as last seen
};

}  // namespace chandelier
