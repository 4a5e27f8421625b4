// SPDX-License-Identifier: Apache-2.0
// How many light clusters there are with one d_init after another, without making them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "lights/light_clusters.h"
#include "lights/point_tree.h"

namespace chandelier::lights {

/// Counts the clusters of select_light_clusters(), without previous centres and anything between lights.
class ClusterCounter {
 public:
  ClusterCounter(std::span<const ClusterLight> lights, const ClusterSettings& settings);

  /// Any number above `most` where there are more.
  size_t count(float d_init_m, size_t most);
  /// No later d_init will be larger. From now on a centre's neighbours up to that one's d_min are looked up once.
  void stay_within(float d_init_m);

 private:
  static constexpr uint32_t not_looked_up = 0xFFFFFFFF;

  struct Neighbour {
    uint32_t rank;
    float distance_m;  // the metric one, rounded up: within the same floats
  };

  PointTree tree_of(double factor) const;
  float d_min_m(float d_init_m, uint32_t rank) const;
  template <typename Visit>
  void visit_later(uint32_t center, float d_min_m, Visit visit) const;
  void cover(uint32_t center, float d_init_m);
  std::span<const Neighbour> neighbours(uint32_t center);

  const ClusterSettings settings_;
  size_t fixed_;                      // clusters that are there with any d_init
  std::vector<ClusterLight> lights_;  // the others', in the order of selection: their ranks
  PointTree omni_;                    // of those that shine all around
  PointTree cones_;                   // of the others
  std::vector<uint8_t> covered_;      // of each rank: is it within d_min of a centre?
  float largest_d_init_m_ = -1.0f;    // negative: not known
  std::vector<Neighbour> neighbours_;
  std::vector<std::pair<uint32_t, uint32_t>> neighbours_of_;  // of each rank the first and end in neighbours_
};

}  // namespace chandelier::lights
