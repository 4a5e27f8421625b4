// SPDX-License-Identifier: Apache-2.0
#include "lights/error_selection.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <queue>
#include <utility>

#include "lights/map_shares.h"
#include "lights/pack_lights.h"
#include "lights/shown_curve.h"

namespace chandelier {
namespace {

constexpr double infinite = std::numeric_limits<double>::infinity();
constexpr uint32_t most_candidates = 16;  // nearest centres that a light is tried with
constexpr uint32_t exchange_below = 8;    // maps; few enough that each matters
constexpr uint32_t exchange_tries = 3;    // centres that are tried as new ones, the most promising

// An assignment of lights to centres, and the picture that it makes: one luminance for each point.
class Search {
 public:
  Search(const LightSamples& samples, DynamicLights dynamic_lights, std::span<const uint32_t> group_centers);

  uint32_t map_count() const { return map_count_; }
  double error() const { return error_; }
  const std::vector<uint32_t>& centers() const { return center_; }
  std::vector<std::vector<uint32_t>> take_neighbours() { return std::move(neighbours_); }

  /// Takes away the centre whose loss raises the error least; false where none can go.
  bool drop_one();
  /// Each light to its best centre, again and again.
  void settle();
  /// Puts other centres in the place of present ones as long as that lowers the error.
  void exchange();

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
    double error;
    uint32_t map_count;
  };

  void order_neighbours(DynamicLights dynamic_lights);
  void join_groups(std::span<const uint32_t> group_centers);
  bool is_grouped(uint32_t light) const { return samples_.light(light).group != 0; }
  double change(uint32_t light, uint32_t from, uint32_t to) const;
  void move(uint32_t light, uint32_t to);
  uint32_t best_center(uint32_t light, uint32_t from, double& best) const;
  bool drop(uint32_t center);
  void add(uint32_t center);
  double drop_cost(uint32_t center);
  uint32_t cheapest_but(uint32_t keep);
  Saved save() const { return {center_, is_center_, luminance_, error_at_, error_, map_count_}; }
  void restore(const Saved& saved);

  const LightSamples& samples_;
  ShownCurve shown_;
  std::vector<std::vector<Contribution>> contributions_;
  std::vector<std::vector<uint32_t>> neighbours_;  // of each light those whose map it may take, nearest first
  std::vector<float> reference_;                   // shown, of each point
  std::vector<uint32_t> center_;                   // of each light
  std::vector<bool> is_center_;
  std::vector<float> luminance_;  // of each point, as the maps have it
  std::vector<float> error_at_;   // of each point, squared
  double error_ = 0.0;
  uint32_t map_count_;
  using Cost = std::pair<double, uint32_t>;
  std::priority_queue<Cost, std::vector<Cost>, std::greater<>> costs_;  // of dropping a centre, as last seen
};

Search::Search(const LightSamples& samples, DynamicLights dynamic_lights, std::span<const uint32_t> group_centers)
    : samples_(samples), map_count_(static_cast<uint32_t>(samples.lights().size())) {
  const glm::vec3 weights(0.2126f, 0.7152f, 0.0722f);
  contributions_.resize(map_count_);
  for (uint32_t light = 0; light < map_count_; ++light)
    for (const auto& reach : samples.reach(light))
      contributions_[light].push_back({reach.point, glm::dot(reach.radiance, weights)});
  for (const auto& point : samples.points()) {
    luminance_.push_back(glm::dot(point.reference, weights));
    reference_.push_back(shown_(luminance_.back()));
  }
  error_at_.assign(luminance_.size(), 0.0f);
  for (uint32_t light = 0; light < map_count_; ++light) center_.push_back(light);
  is_center_.assign(map_count_, true);
  order_neighbours(dynamic_lights);
  join_groups(group_centers);
  for (uint32_t light = 0; light < center_.size(); ++light)
    if (is_center_[light]) costs_.push({drop_cost(light), light});
}

// Once and for all: no light of a group has neighbours.
void Search::join_groups(std::span<const uint32_t> group_centers) {
  for (uint32_t light = 0; light < group_centers.size(); ++light) {
    if (!is_grouped(light) || group_centers[light] == light) continue;
    is_center_[light] = false;
    --map_count_;
    move(light, group_centers[light]);
  }
}

// Nearest first, directional lights by their directions. A light that keeps its own map, or its group's, has none, and
// is nobody's.
void Search::order_neighbours(DynamicLights dynamic_lights) {
  const auto keeps_own = [&](const pack::Light& light) {
    return light.group != 0 || light.unclustered != 0 || (light.dynamic != 0 && dynamic_lights == DynamicLights::own);
  };
  neighbours_.resize(map_count_);
  for (uint32_t light = 0; light < map_count_; ++light) {
    const pack::Light& from = samples_.light(light);
    std::vector<std::pair<float, uint32_t>> others;
    for (uint32_t other = 0; other < map_count_; ++other) {
      const pack::Light& to = samples_.light(other);
      if (other == light || keeps_own(from) || keeps_own(to) || is_directional(from) != is_directional(to)) continue;
      others.push_back({is_directional(from) ? glm::distance(from.direction_ws, to.direction_ws)
                                             : glm::distance(from.position_ws, to.position_ws),
                        other});
    }
    std::sort(others.begin(), others.end());
    for (const auto& [distance, other] : others) neighbours_[light].push_back(other);
  }
}

// Of the sum of squared errors, were a light to take another map.
double Search::change(uint32_t light, uint32_t from, uint32_t to) const {
  double sum = 0.0;
  for (const Contribution& c : contributions_[light]) {
    const bool before = samples_.sees(from, c.point), after = samples_.sees(to, c.point);
    if (before == after) continue;
    const float difference = shown_(luminance_[c.point] + (after ? c.luminance : -c.luminance)) - reference_[c.point];
    sum += difference * difference - error_at_[c.point];
  }
  return sum;
}

void Search::move(uint32_t light, uint32_t to) {
  const uint32_t from = std::exchange(center_[light], to);
  if (from == to) return;
  for (const Contribution& c : contributions_[light]) {
    const bool before = samples_.sees(from, c.point), after = samples_.sees(to, c.point);
    if (before == after) continue;
    luminance_[c.point] += after ? c.luminance : -c.luminance;
    const float difference = shown_(luminance_[c.point]) - reference_[c.point];
    error_ += difference * difference - std::exchange(error_at_[c.point], difference * difference);
  }
}

// Of the nearest centres the one that lowers the error most, by more than `best`; `from` where there is none.
uint32_t Search::best_center(uint32_t light, uint32_t from, double& best) const {
  uint32_t chosen = from;
  uint32_t tried = 0;
  for (uint32_t other : neighbours_[light]) {
    if (!is_center_[other]) continue;
    const double d = other == from ? infinite : change(light, from, other);
    if (d < best) {
      best = d;
      chosen = other;
    }
    if (++tried == most_candidates) break;
  }
  return chosen;
}

bool Search::drop(uint32_t center) {
  is_center_[center] = false;
  --map_count_;
  for (uint32_t light = 0; light < center_.size(); ++light) {
    if (center_[light] != center) continue;
    double best = infinite;
    const uint32_t to = best_center(light, center, best);
    if (to == center) return false;
    move(light, to);
  }
  return true;
}

double Search::drop_cost(uint32_t center) {
  const Saved before = save();
  const double cost = drop(center) ? error_ - before.error : infinite;
  restore(before);
  return cost;
}

void Search::restore(const Saved& saved) {
  center_ = saved.center;
  is_center_ = saved.is_center;
  luminance_ = saved.luminance;
  error_at_ = saved.error_at;
  error_ = saved.error;
  map_count_ = saved.map_count;
}

void Search::add(uint32_t center) {
  is_center_[center] = true;
  ++map_count_;
  move(center, center);
  for (uint32_t light = 0; light < center_.size(); ++light) {
    const bool may = !is_center_[light] && !is_grouped(light) &&
                     is_directional(samples_.light(light)) == is_directional(samples_.light(center));
    if (may && change(light, center_[light], center) < 0.0) move(light, center);
  }
}

// Costs change little from step to step, so that only the cheapest is asked anew until it stays the cheapest.
bool Search::drop_one() {
  while (!costs_.empty()) {
    const uint32_t center = costs_.top().second;
    costs_.pop();
    const double cost = is_center_[center] ? drop_cost(center) : infinite;
    if (cost == infinite) continue;
    if (costs_.empty() || Cost(cost, center) <= costs_.top()) return drop(center);
    costs_.push({cost, center});
  }
  return false;
}

void Search::settle() {
  bool moved = true;
  for (uint32_t pass = 0; moved && pass < 4; ++pass) {
    moved = false;
    for (uint32_t light = 0; light < center_.size(); ++light) {
      if (is_center_[light]) continue;
      double best = -1e-6 * error_;
      const uint32_t to = best_center(light, center_[light], best);
      if (to == center_[light]) continue;
      move(light, to);
      moved = true;
    }
  }
}

uint32_t Search::cheapest_but(uint32_t keep) {
  Cost cheapest{infinite, keep};
  for (uint32_t center = 0; center < is_center_.size(); ++center)
    if (is_center_[center] && center != keep) cheapest = std::min(cheapest, {drop_cost(center), center});
  return cheapest.second;
}

void Search::exchange() {
  for (bool better = true; better;) {
    better = false;
    const Saved before = save();
    std::vector<Cost> gains;
    for (uint32_t light = 0; light < is_center_.size(); ++light) {
      if (is_center_[light] || is_grouped(light)) continue;
      add(light);
      gains.push_back({error_, light});
      restore(before);
    }
    std::sort(gains.begin(), gains.end());
    for (size_t i = 0; i < std::min<size_t>(gains.size(), exchange_tries) && !better; ++i) {
      add(gains[i].second);
      const uint32_t worst = cheapest_but(gains[i].second);
      better = worst != gains[i].second && drop(worst);
      settle();
      better = better && error_ < before.error - std::max(1e-3 * before.error, 1e-9);
      if (!better) restore(before);
    }
  }
  costs_ = {};
  for (uint32_t center = 0; center < is_center_.size(); ++center)
    if (is_center_[center]) costs_.push({drop_cost(center), center});
}

}  // namespace

ErrorLadder::ErrorLadder(const LightSamples& samples, DynamicLights dynamic_lights,
                         std::span<const uint32_t> group_centers)
    : samples_(samples) {
  Search search(samples, dynamic_lights, group_centers);
  most_maps_ = search.map_count();
  rungs_.push_back({search.centers(), search.error()});
  while (search.drop_one()) {
    search.settle();
    if (search.map_count() <= exchange_below) search.exchange();
    rungs_.push_back({search.centers(), search.error()});
  }
  lenders_ = search.take_neighbours();
  std::reverse(rungs_.begin(), rungs_.end());
  for (size_t i = 1; i < rungs_.size(); ++i)
    if (rungs_[i].error > rungs_[i - 1].error) rungs_[i] = rungs_[i - 1];
  members_.resize(rungs_.size());
}

uint32_t ErrorLadder::fewest_maps() const {
  return static_cast<uint32_t>(most_maps_ + 1 - rungs_.size());
}

const std::vector<MapMember>& ErrorLadder::members(size_t rung) const {
  if (members_[rung].empty()) members_[rung] = share_out(samples_, rungs_[rung].center, lenders_);
  return members_[rung];
}

std::vector<MapMember> ErrorLadder::with_at_most(uint32_t maps) const {
  const uint32_t fewest = fewest_maps();
  return members(std::min<size_t>(std::max(maps, fewest) - fewest, rungs_.size() - 1));
}

std::vector<MapMember> ErrorLadder::within(double most_rmse, const LightSamples& judge,
                                           const ShadowReading& reading) const {
  size_t low = 0, high = rungs_.size() - 1;
  while (low < high) {
    const size_t middle = (low + high) / 2;
    if (estimated_rmse(judge, members(middle), reading) <= most_rmse)
      high = middle;
    else
      low = middle + 1;
  }
  return members(low);
}

}  // namespace chandelier
