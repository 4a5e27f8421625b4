// SPDX-License-Identifier: Apache-2.0
// LightCluster §3.1: minimum-distance clustering of lights.
#include "lights/light_clusters.h"

#include <algorithm>
#include <limits>
#include <unordered_map>
#include <utility>

#include "lights/point_tree.h"
#include "lights/selection_order.h"

namespace chandelier::lights {
namespace {

float to_float(double metres) {
  return static_cast<float>(std::min(metres, double{std::numeric_limits<float>::max()}));
}

struct Candidate {
  double distance_m;
  uint32_t rank;  // in the order of selection
  uint32_t center;

  bool before(const Candidate& other) const {
    return distance_m != other.distance_m ? distance_m < other.distance_m : rank < other.rank;
  }
};

class Selection {
 public:
  Selection(std::span<const ClusterLight> lights, const ClusterSettings& settings, const Blocked& blocked)
      : lights_(lights),
        settings_(settings),
        blocked_(blocked),
        order_(order_of(
            [&](uint32_t light) { return lights[light].group == 0 && !has_own_center(lights[light], settings); })),
        omni_(tree_of([&](uint32_t light) { return straight_per_metric(lights_[light]) == 1.0; })),
        cones_(tree_of([&](uint32_t light) { return straight_per_metric(lights_[light]) > 1.0; })),
        d_min_(lights.size()),
        rank_(lights.size(), none),
        nearest_(lights.size()) {}

  LightClusters clusters();

 private:
  static constexpr uint32_t none = no_center;

  bool clings() const { return settings_.stability > 0.0f && !settings_.previous_centers.empty(); }
  bool was_center(uint32_t light) const { return clings() && settings_.previous_centers[light] == light; }
  // How much of a centre's d_min counts for a light that it might cover.
  double largest_d_min_factor() const { return clings() ? 1.0 + 0.25 * double{settings_.stability} : 1.0; }
  double d_min_factor(uint32_t light) const {
    return was_center(light) ? 1.0 - double{settings_.stability} : largest_d_min_factor();
  }
  bool is_blocked(uint32_t light, uint32_t center) const { return blocked_ && blocked_(light, center); }
  double distance_m(uint32_t light, uint32_t center) const {
    return metric_distance_m(lights_[light], lights_[center].position_ws);
  }

  template <typename Which>
  std::vector<uint32_t> order_of(Which which) const {
    return selection_order(lights_, which, [&](uint32_t light) { return was_center(light); });
  }
  template <typename Which>
  PointTree tree_of(Which which) const;
  void select_centers();
  void cover(const PointTree& lights, double factor, uint32_t center);
  void join_nearest();
  void join_groups();
  bool is_nearest_of_all(const Candidate& nearest, uint32_t light) const;
  Candidate nearest_center(const PointTree& centers, uint32_t light) const;

  const std::span<const ClusterLight> lights_;
  ClusterSettings settings_;
  const Blocked blocked_;
  const std::vector<uint32_t> order_;  // without the lights that have a centre of their own, or a group
  const PointTree omni_;               // of the lights in order_ that shine all around
  const PointTree cones_;              // of the others
  std::vector<float> d_min_;           // that each light would have as a centre
  std::vector<uint32_t> rank_;         // of each light that is a centre
  std::vector<Candidate> nearest_;
};

template <typename Which>
PointTree Selection::tree_of(Which which) const {
  std::vector<PointTree::Point> points;
  for (const uint32_t light : order_)
    if (which(light)) points.push_back({lights_[light].position_ws, light});
  return PointTree(std::move(points));
}

// §3.1.2, from the centres' side: each covers the lights within its d_min, and who is reached uncovered is a centre.
void Selection::select_centers() {
  for (uint32_t light = 0; light < lights_.size(); ++light) {
    d_min_[light] = scaled_d_min(settings_, lights_[light].position_ws);
    rank_[light] = none;
  }
  for (uint32_t light = 0; light < lights_.size(); ++light) nearest_[light] = {0.0, none, light};  // own centres
  for (const uint32_t light : order_) nearest_[light] = {std::numeric_limits<double>::infinity(), none, none};
  for (uint32_t i = 0; i < order_.size(); ++i) {
    const uint32_t light = order_[i];
    if (nearest_[light].center != none) continue;
    rank_[light] = i;
    nearest_[light] = {0.0, i, light};
    cover(omni_, 1.0, light);
    cover(cones_, 2.0, light);
  }
}

void Selection::cover(const PointTree& lights, double factor, uint32_t center) {
  const double d_min = d_min_[center];
  const SquaredRadius radius(factor * largest_d_min_factor() * d_min);
  lights.visit_near(lights_[center].position_ws, radius, [&](uint32_t light) {
    const Candidate candidate{distance_m(light, center), rank_[center], center};
    const bool covers = candidate.distance_m <= d_min_factor(light) * d_min;
    if (covers && candidate.before(nearest_[light]) && !is_blocked(light, center)) nearest_[light] = candidate;
  });
}

// d_min changes by no more than `slope` per metre. A centre that is nearer to the light than `nearest` has a d_min of
// at least the light's own less slope * straight distance: where that is more than its distance, it covers the light,
// and was met when it was selected.
bool Selection::is_nearest_of_all(const Candidate& nearest, uint32_t light) const {
  const double slope =
      settings_.scaling == DistanceScaling::none ? 0.0 : double{settings_.d_init_m} / double{settings_.z_far_m};
  const double own_d_min = 0.99999 * d_min_[light];  // for rounding's sake
  const double least_d_min = own_d_min - slope * straight_per_metric(lights_[light]) * nearest.distance_m;
  return nearest.distance_m < d_min_factor(light) * least_d_min;
}

// §3.1.3. The nearest of the centres that cover a light bounds the search for its nearest one.
Candidate Selection::nearest_center(const PointTree& centers, uint32_t light) const {
  Candidate nearest = nearest_[light];
  const double own_factor = straight_per_metric(lights_[light]);
  SquaredRadius radius(own_factor * nearest.distance_m);
  centers.visit_near(lights_[light].position_ws, radius, [&](uint32_t center) {
    const Candidate candidate{distance_m(light, center), rank_[center], center};
    if (!candidate.before(nearest) || is_blocked(light, center)) return;
    nearest = candidate;
    radius = SquaredRadius(own_factor * nearest.distance_m);
  });
  return nearest;
}

void Selection::join_nearest() {
  const PointTree centers = tree_of([&](uint32_t light) { return rank_[light] != none; });
  for (const uint32_t light : order_) {
    if (rank_[light] != none) continue;
    Candidate& nearest = nearest_[light];
    if (!is_nearest_of_all(nearest, light)) nearest = nearest_center(centers, light);
    if (!clings()) continue;
    const uint32_t last = settings_.previous_centers[light];
    if (last >= lights_.size() || rank_[last] == none || last == nearest.center) continue;
    const double distance = distance_m(light, last);
    if (distance <= d_min_factor(light) * d_min_[last] && !is_blocked(light, last))
      nearest = {distance, rank_[last], last};
  }
}

void Selection::join_groups() {
  std::unordered_map<uint32_t, uint32_t> center_of_group;
  for (const uint32_t light : order_of([&](uint32_t each) { return lights_[each].group != 0; })) {
    const uint32_t center = center_of_group.try_emplace(lights_[light].group, light).first->second;
    nearest_[light] = {distance_m(light, center), none, center};
  }
}

// In the order of their centres' indices: with d_init 0 that is the order of the lights.
LightClusters Selection::clusters() {
  select_centers();
  join_nearest();
  join_groups();
  LightClusters result;
  std::vector<uint32_t> cluster_of_center(lights_.size());
  for (uint32_t light = 0; light < lights_.size(); ++light) {
    if (nearest_[light].center != light) continue;
    cluster_of_center[light] = static_cast<uint32_t>(result.clusters.size());
    result.clusters.push_back({light, d_min_[light], 0.0f, 0.0f, 0});
  }
  for (uint32_t light = 0; light < lights_.size(); ++light) {
    const Candidate& nearest = nearest_[light];
    const uint32_t number = cluster_of_center[nearest.center];
    const double straight = straight_distance_m(lights_[light].position_ws, lights_[nearest.center].position_ws);
    LightCluster& joined = result.clusters[number];
    joined.range_m = std::max(joined.range_m, to_float(straight + double{lights_[light].range_m}));
    joined.spread_m = std::max(joined.spread_m, to_float(nearest.distance_m));
    ++joined.light_count;
    result.cluster_of_light.push_back(number);
  }
  return result;
}

}  // namespace

float scaled_d_min(const ClusterSettings& settings, const glm::vec3& center_ws) {
  const double depth = straight_distance_m(settings.camera_ws, center_ws) / double{settings.z_far_m};
  switch (settings.scaling) {
    case DistanceScaling::grow:
      return to_float(settings.d_init_m * (1.0 + depth));
    case DistanceScaling::paper_formula:
      return to_float(settings.d_init_m * std::max(0.0, 1.0 - depth));
    case DistanceScaling::none:
      break;
  }
  return settings.d_init_m;
}

bool has_own_center(const ClusterLight& light, const ClusterSettings& settings) {
  return light.group == 0 && (light.unclustered || (light.dynamic && settings.dynamic_lights == DynamicLights::own));
}

LightClusters select_light_clusters(std::span<const ClusterLight> lights, const ClusterSettings& settings,
                                    const Blocked& blocked) {
  return Selection(lights, settings, blocked).clusters();
}

}  // namespace chandelier::lights
