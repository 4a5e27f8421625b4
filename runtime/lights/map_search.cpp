// SPDX-License-Identifier: Apache-2.0
#include "lights/map_search.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <tuple>

#include "lights/search_stopped.h"

namespace chandelier {
namespace {

constexpr double infinite = std::numeric_limits<double>::infinity();
constexpr uint32_t exchange_tries = 3;       // centres that are tried as new ones, the most promising
constexpr uint32_t remembered_centers = 64;  // nearest ones of a light: looked up anew when few of them are left

}  // namespace

MapSearch::MapSearch(const LightSamples& samples, const MapCandidates& candidates,
                     std::span<const uint32_t> group_centers, const std::stop_token& stop)
    : samples_(samples),
      candidates_(candidates),
      stop_(stop),
      map_count_(static_cast<uint32_t>(samples.lights().size())) {
  const glm::vec3 weights(0.2126f, 0.7152f, 0.0722f);
  contributions_.resize(map_count_);
  for (uint32_t light = 0; light < map_count_; ++light) {
    stop_if_asked(stop_);
    for (const auto& contribution : samples.contributions(light))
      contributions_[light].push_back({contribution.point, glm::dot(contribution.radiance, weights)});
  }
  for (const auto& point : samples.points()) {
    luminance_.push_back(glm::dot(point.reference, weights));
    reference_.push_back(shown_(luminance_.back()));
  }
  error_at_.assign(luminance_.size(), 0.0f);
  changed_at_.assign(luminance_.size(), 0);
  center_.resize(map_count_);
  std::iota(center_.begin(), center_.end(), 0u);
  is_center_.assign(map_count_, true);
  nearest_.resize(map_count_);
  known_.resize(map_count_);
  join_groups(group_centers);
  list_centers();
  count_costs();
}

// Once and for all: no light of a group has candidates.
void MapSearch::join_groups(std::span<const uint32_t> group_centers) {
  for (uint32_t light = 0; light < group_centers.size(); ++light) {
    if (!is_grouped(light) || group_centers[light] == light) continue;
    is_center_[light] = false;
    --map_count_;
    move(light, group_centers[light]);
  }
}

void MapSearch::count_costs() {
  costs_ = {};
  for (uint32_t center = 0; center < is_center_.size(); ++center)
    if (is_center_[center]) costs_.push({drop_cost(center), center});
}

void MapSearch::list_centers() {
  listed_.clear();
  for (uint32_t light = 0; light < is_center_.size(); ++light)
    if (is_center_[light]) listed_.push_back(light);
}

size_t MapSearch::candidate_entries() const {
  return std::accumulate(nearest_.begin(), nearest_.end(), size_t{0},
                         [](size_t sum, const Nearest& nearest) { return sum + nearest.centers.capacity(); });
}

// The nearest centres whose map the light may take.
void MapSearch::find_candidates(uint32_t light) {
  if (map_count_ <= exchange_below + 1) {  // exchange() brings centres back
    std::vector<uint32_t> centers;
    for (uint32_t i = 0; i < is_center_.size(); ++i)
      if (is_center_[i]) centers.push_back(i);
    candidates_.nearest(light, centers, most_candidates, found_);
    return;
  }
  Nearest& nearest = nearest_[light];
  const auto gather = [&] {
    found_.clear();
    for (const uint32_t center : nearest.centers)
      if (is_center_[center] && found_.size() < most_candidates) found_.push_back(center);
    return nearest.is_filled && (nearest.is_all || found_.size() == most_candidates);
  };
  if (gather()) return;
  candidates_.nearest(light, listed_, remembered_centers, nearest.centers);
  nearest.centers.shrink_to_fit();
  nearest.is_filled = true;
  nearest.is_all = nearest.centers.size() < remembered_centers;
  gather();
}

// Of the sum of squared errors, were a light to take another map.
double MapSearch::change(uint32_t light, uint32_t from, uint32_t to) const {
  double sum = 0.0;
  for (const Contribution& c : contributions_[light]) {
    const bool before = samples_.sees(from, c.point), after = samples_.sees(to, c.point);
    if (before == after) continue;
    const float difference = shown_(luminance_[c.point] + (after ? c.luminance : -c.luminance)) - reference_[c.point];
    sum += difference * difference - error_at_[c.point];
  }
  return sum;
}

void MapSearch::move(uint32_t light, uint32_t to) {
  const uint32_t from = std::exchange(center_[light], to);
  if (from == to) return;
  ++clock_;
  for (const Contribution& c : contributions_[light]) {
    const bool before = samples_.sees(from, c.point), after = samples_.sees(to, c.point);
    if (before == after) continue;
    luminance_[c.point] += after ? c.luminance : -c.luminance;
    const float difference = shown_(luminance_[c.point]) - reference_[c.point];
    error_ += difference * difference - std::exchange(error_at_[c.point], difference * difference);
    changed_at_[c.point] = clock_;
  }
}

// Of the nearest centres the one that lowers the error most or raises it least, and by how much; no change and its own
// centre where there is none.
std::pair<double, uint32_t> MapSearch::best_move(uint32_t light) {
  const uint32_t from = center_[light];
  find_candidates(light);
  std::pair<double, uint32_t> best{infinite, from};
  for (const uint32_t other : found_) {
    const double d = other == from ? infinite : change(light, from, other);
    if (d < best.first) best = {d, other};
  }
  return best;
}

// The same, without looking again where the light's candidates and points are as they were.
std::pair<double, uint32_t> MapSearch::known_best_move(uint32_t light) {
  Known& known = known_[light];
  find_candidates(light);
  const auto is_unchanged = [&](const Contribution& c) { return changed_at_[c.point] < known.looked_at; };
  const bool is_known = known.looked_at > 0 && known.from == center_[light] && known.candidates == found_ &&
                        std::all_of(contributions_[light].begin(), contributions_[light].end(), is_unchanged);
  if (!is_known) {
    known.candidates = found_;
    known.from = center_[light];
    std::tie(known.change, known.to) = best_move(light);
  }
  known.looked_at = clock_ + 1;
  return {known.change, known.to};
}

bool MapSearch::drop(uint32_t center) {
  is_center_[center] = false;
  --map_count_;
  for (uint32_t light = 0; light < center_.size(); ++light) {
    if (center_[light] != center) continue;
    stop_if_asked(stop_);
    const uint32_t to = best_move(light).second;
    if (to == center) return false;
    move(light, to);
  }
  return true;
}

double MapSearch::drop_cost(uint32_t center) {
  stop_if_asked(stop_);
  const Saved before = save();
  const double cost = drop(center) ? error_ - before.error : infinite;
  restore(before);
  return cost;
}

// The clock goes on: what settle() learned after the save is not known any more (exchange() forgets it).
void MapSearch::restore(const Saved& saved) {
  center_ = saved.center;
  is_center_ = saved.is_center;
  luminance_ = saved.luminance;
  error_at_ = saved.error_at;
  changed_at_ = saved.changed_at;
  error_ = saved.error;
  map_count_ = saved.map_count;
}

void MapSearch::add(uint32_t center) {
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
bool MapSearch::drop_one() {
  while (!costs_.empty()) {
    const uint32_t center = costs_.top().second;
    costs_.pop();
    const double cost = is_center_[center] ? drop_cost(center) : infinite;
    if (cost == infinite) continue;
    if (costs_.empty() || Cost(cost, center) <= costs_.top()) {
      const bool is_dropped = drop(center);
      list_centers();
      return is_dropped;
    }
    costs_.push({cost, center});
  }
  return false;
}

void MapSearch::settle() {
  bool moved = true;
  for (uint32_t pass = 0; moved && pass < 4; ++pass) {
    moved = false;
    for (uint32_t light = 0; light < center_.size(); ++light) {
      if (is_center_[light]) continue;
      stop_if_asked(stop_);
      const auto [change, to] = known_best_move(light);
      if (!(change < -1e-6 * error_)) continue;
      move(light, to);
      moved = true;
    }
  }
}

uint32_t MapSearch::cheapest_but(uint32_t keep) {
  Cost cheapest{infinite, keep};
  for (uint32_t center = 0; center < is_center_.size(); ++center)
    if (is_center_[center] && center != keep) cheapest = std::min(cheapest, {drop_cost(center), center});
  return cheapest.second;
}

void MapSearch::exchange() {
  for (bool better = true; better;) {
    better = false;
    const Saved before = save();
    std::vector<Cost> gains;
    for (uint32_t light = 0; light < is_center_.size(); ++light) {
      if (is_center_[light] || is_grouped(light)) continue;
      stop_if_asked(stop_);
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
      for (Known& known : known_) known.looked_at = 0;
    }
  }
  list_centers();
  count_costs();
}

}  // namespace chandelier
