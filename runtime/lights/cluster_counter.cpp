// SPDX-License-Identifier: Apache-2.0
// LightCluster §3.1.2 alone: who becomes a centre, not who joins it.
#include "lights/cluster_counter.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "lights/selection_order.h"

namespace chandelier::lights {
namespace {

float rounded_up(double metres) {
  const auto nearest = static_cast<float>(metres);
  return double{nearest} < metres ? std::nextafter(nearest, std::numeric_limits<float>::infinity()) : nearest;
}

// Lights with a centre of their own, and groups.
size_t count_fixed(std::span<const ClusterLight> lights, const ClusterSettings& settings) {
  size_t own = 0;
  std::vector<uint32_t> groups;
  for (const ClusterLight& light : lights) {
    own += has_own_center(light, settings);
    if (light.group != 0) groups.push_back(light.group);
  }
  std::sort(groups.begin(), groups.end());
  return own + static_cast<size_t>(std::unique(groups.begin(), groups.end()) - groups.begin());
}

std::vector<ClusterLight> in_order(std::span<const ClusterLight> lights, const ClusterSettings& settings) {
  const auto is_clustered = [&](uint32_t light) {
    return lights[light].group == 0 && !has_own_center(lights[light], settings);
  };
  std::vector<ClusterLight> ordered;
  for (const uint32_t light : selection_order(lights, is_clustered, [](uint32_t) { return false; }))
    ordered.push_back(lights[light]);
  return ordered;
}

}  // namespace

ClusterCounter::ClusterCounter(std::span<const ClusterLight> lights, const ClusterSettings& settings)
    : settings_(settings),
      fixed_(count_fixed(lights, settings)),
      lights_(in_order(lights, settings)),
      omni_(tree_of(1.0)),
      cones_(tree_of(2.0)),
      covered_(lights_.size()) {}

PointTree ClusterCounter::tree_of(double factor) const {
  std::vector<PointTree::Point> points;
  for (uint32_t rank = 0; rank < lights_.size(); ++rank)
    if (lights::straight_per_metric(lights_[rank]) == factor) points.push_back({lights_[rank].position_ws, rank});
  return PointTree(std::move(points));
}

float ClusterCounter::d_min_m(float d_init_m, uint32_t rank) const {
  ClusterSettings settings = settings_;
  settings.d_init_m = d_init_m;
  return scaled_d_min(settings, lights_[rank].position_ws);
}

// visit(rank) for the lights after a centre that may be within its d_min.
template <typename Visit>
void ClusterCounter::visit_later(uint32_t center, float d_min_m, Visit visit) const {
  const auto if_later = [&](uint32_t rank) {
    if (rank > center) visit(rank);
  };
  omni_.visit_near(lights_[center].position_ws, SquaredRadius(d_min_m), if_later);
  cones_.visit_near(lights_[center].position_ws, SquaredRadius(2.0 * double{d_min_m}), if_later);
}

void ClusterCounter::stay_within(float d_init_m) {
  largest_d_init_m_ = d_init_m;
  neighbours_.clear();
  neighbours_of_.assign(lights_.size(), {not_looked_up, 0});
}

std::span<const ClusterCounter::Neighbour> ClusterCounter::neighbours(uint32_t center) {
  auto& [first, end] = neighbours_of_[center];
  if (first == not_looked_up) {
    const float most_m = d_min_m(largest_d_init_m_, center);
    first = static_cast<uint32_t>(neighbours_.size());
    visit_later(center, most_m, [&](uint32_t rank) {
      const double distance_m = metric_distance_m(lights_[rank], lights_[center].position_ws);
      if (distance_m <= double{most_m}) neighbours_.push_back({rank, rounded_up(distance_m)});
    });
    end = static_cast<uint32_t>(neighbours_.size());
  }
  return std::span(neighbours_).subspan(first, end - first);
}

void ClusterCounter::cover(uint32_t center, float d_init_m) {
  const float covered_up_to_m = d_min_m(d_init_m, center);
  if (d_init_m <= largest_d_init_m_) {
    for (const Neighbour& each : neighbours(center))
      if (each.distance_m <= covered_up_to_m) covered_[each.rank] = 1;
    return;
  }
  visit_later(center, covered_up_to_m, [&](uint32_t rank) {
    if (!covered_[rank])
      covered_[rank] = metric_distance_m(lights_[rank], lights_[center].position_ws) <= double{covered_up_to_m};
  });
}

size_t ClusterCounter::count(float d_init_m, size_t most) {
  std::fill(covered_.begin(), covered_.end(), uint8_t{0});
  size_t clusters = fixed_;
  for (uint32_t rank = 0; rank < lights_.size() && clusters <= most; ++rank) {
    if (covered_[rank]) continue;
    ++clusters;
    cover(rank, d_init_m);
  }
  return clusters;
}

}  // namespace chandelier::lights
