// SPDX-License-Identifier: Apache-2.0
#include "lights/map_shares.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "lights/search_stopped.h"
#include "lights/shown_curve.h"

namespace chandelier {
namespace {

constexpr size_t most_shares = 3;
constexpr float least_share = 0.05f;
constexpr double least_gain = 0.003;  // of the squared error, for which a light is worth shading more than once
constexpr uint32_t most_passes = 12;
constexpr uint32_t most_candidates = 16;  // nearest centres that a light may take shares of

struct Share {
  uint32_t center;
  float part;  // 0 to 1
};

// Shares of all lights, and the picture that they make: one luminance for each point.
class Sharing {
 public:
  Sharing(const LightSamples& samples, std::span<const uint32_t> center, const std::stop_token& stop);

  double error() const { return error_; }  // sum of squares
  const std::vector<Share>& shares(uint32_t light) const { return shares_[light]; }

  /// Moves a part of a light from the worst of its maps to the best of all; false where that lowers no error.
  bool improve(uint32_t light, std::span<const uint32_t> candidates);
  /// Gives up small shares, and all but one where they gain too little.
  void tidy(uint32_t light);

 private:
  struct Contribution {
    uint32_t point;
    float luminance;
  };

  // Calls use(contribution, 1 or -1) wherever one of two maps sees a point and the other does not.
  template <typename Use>
  void where_they_differ(uint32_t light, uint32_t from, uint32_t to, Use use) const {
    for (const Contribution& c : contributions_[light]) {
      const bool before = samples_.sees(from, c.point), after = samples_.sees(to, c.point);
      if (before != after) use(c, after ? 1.0f : -1.0f);
    }
  }
  double squared_error(uint32_t point, float luminance) const {
    const double d = shown_(luminance) - shown_(reference_[point]);
    return d * d;
  }
  double change(uint32_t light, uint32_t from, uint32_t to, float part) const;
  void shift(uint32_t light, uint32_t from, uint32_t to, float part);
  float best_part(uint32_t light, uint32_t from, uint32_t to) const;
  void pull_at(uint32_t light, std::vector<float>& pull) const;
  void unite(uint32_t light, uint32_t center);

  const LightSamples& samples_;
  ShownCurve shown_;
  std::vector<std::vector<Contribution>> contributions_;
  std::vector<float> reference_;  // luminance of each point
  std::vector<float> luminance_;  // as the shares have it
  std::vector<std::vector<Share>> shares_;
  double error_ = 0.0;
};

Sharing::Sharing(const LightSamples& samples, std::span<const uint32_t> center, const std::stop_token& stop)
    : samples_(samples) {
  const glm::vec3 weights(0.2126f, 0.7152f, 0.0722f);
  for (const auto& point : samples.points()) {
    reference_.push_back(glm::dot(point.reference, weights));
    luminance_.push_back(glm::dot(point.unshadowable, weights));
  }
  contributions_.resize(center.size());
  for (uint32_t light = 0; light < center.size(); ++light) {
    stop_if_asked(stop);
    shares_.push_back({{center[light], 1.0f}});
    for (const auto& contribution : samples.contributions(light)) {
      contributions_[light].push_back({contribution.point, glm::dot(contribution.radiance, weights)});
      if (samples.sees(center[light], contribution.point))
        luminance_[contribution.point] += contributions_[light].back().luminance;
    }
  }
  for (uint32_t p = 0; p < luminance_.size(); ++p) error_ += squared_error(p, luminance_[p]);
}

double Sharing::change(uint32_t light, uint32_t from, uint32_t to, float part) const {
  double sum = 0.0;
  where_they_differ(light, from, to, [&](const Contribution& c, float sign) {
    const float before = luminance_[c.point];
    sum += squared_error(c.point, before + sign * part * c.luminance) - squared_error(c.point, before);
  });
  return sum;
}

void Sharing::shift(uint32_t light, uint32_t from, uint32_t to, float part) {
  error_ += change(light, from, to, part);
  where_they_differ(light, from, to,
                    [&](const Contribution& c, float sign) { luminance_[c.point] += sign * part * c.luminance; });
  auto& shares = shares_[light];
  const auto of = [&](uint32_t center) {
    return std::find_if(shares.begin(), shares.end(), [&](const Share& s) { return s.center == center; });
  };
  if (of(to) == shares.end()) shares.push_back({to, 0.0f});
  of(to)->part += part;
  of(from)->part -= part;
  if (of(from)->part < 1e-6f) shares.erase(of(from));
}

// How much is best moved from map to map, were the tone curve straight between what is and what should be.
float Sharing::best_part(uint32_t light, uint32_t from, uint32_t to) const {
  double pull = 0.0, stiffness = 0.0;
  where_they_differ(light, from, to, [&](const Contribution& c, float sign) {
    const float off = luminance_[c.point] - reference_[c.point];
    const float step = std::abs(off) > 1e-3f * reference_[c.point] + 1e-5f ? off : 1e-3f * reference_[c.point] + 1e-5f;
    const double slope = (shown_(reference_[c.point] + step) - shown_(reference_[c.point])) / step;
    pull -= slope * slope * off * sign * c.luminance;
    stiffness += slope * slope * c.luminance * c.luminance;
  });
  return stiffness > 0.0 ? static_cast<float>(pull / stiffness) : 0.0f;
}

// Half of what a little luminance more would do to the squared error, of each of a light's contributions.
void Sharing::pull_at(uint32_t light, std::vector<float>& pull) const {
  pull.clear();
  for (const Contribution& c : contributions_[light]) {
    const float is = luminance_[c.point], step = 1e-3f * is + 1e-4f;
    pull.push_back((shown_(is) - shown_(reference_[c.point])) * (shown_(is + step) - shown_(is)) / step * c.luminance);
  }
}

bool Sharing::improve(uint32_t light, std::span<const uint32_t> candidates) {
  std::vector<float> pull;
  pull_at(light, pull);
  const auto slope = [&](uint32_t center) {  // of the squared error, by the part in this map
    double sum = 0.0;
    for (size_t i = 0; i < pull.size(); ++i)
      if (samples_.sees(center, contributions_[light][i].point)) sum += pull[i];
    return sum;
  };
  std::pair<double, uint32_t> worst{-std::numeric_limits<double>::infinity(), 0};
  std::pair<double, uint32_t> best{std::numeric_limits<double>::infinity(), 0};
  for (const Share& share : shares_[light]) {
    const double s = slope(share.center);
    worst = std::max(worst, {s, share.center});
    best = std::min(best, {s, share.center});
  }
  if (shares_[light].size() < most_shares)
    for (const uint32_t center : candidates) best = std::min(best, {slope(center), center});
  if (best.first >= worst.first) return false;

  const auto from = std::find_if(shares_[light].begin(), shares_[light].end(),
                                 [&](const Share& s) { return s.center == worst.second; });
  float part = std::min(best_part(light, worst.second, best.second), from->part);
  for (; part > 1e-3f; part *= 0.5f) {
    if (change(light, worst.second, best.second, part) >= -1e-7 * error_) continue;
    shift(light, worst.second, best.second, part);
    return true;
  }
  return false;
}

void Sharing::unite(uint32_t light, uint32_t center) {
  const std::vector<Share> before = shares_[light];
  for (const Share& share : before)
    if (share.center != center) shift(light, share.center, center, share.part);
  shares_[light] = {{center, 1.0f}};
}

void Sharing::tidy(uint32_t light) {
  auto& shares = shares_[light];
  const auto larger = [](const Share& a, const Share& b) { return a.part > b.part; };
  std::sort(shares.begin(), shares.end(), larger);
  while (shares.size() > 1 && shares.back().part < least_share)
    shift(light, shares.back().center, shares.front().center, shares.back().part);
  if (shares.size() < 2) return;
  const std::vector<Share> several = shares;
  const double before = error_;
  const std::vector<float> luminance = luminance_;
  std::pair<double, uint32_t> best{std::numeric_limits<double>::infinity(), 0};  // the light whole in one of its maps
  for (const Share& share : several) {
    unite(light, share.center);
    best = std::min(best, {error_, share.center});
    shares = several;
    luminance_ = luminance;
    error_ = before;
  }
  if (best.first - before < least_gain * before) unite(light, best.second);
}

}  // namespace

std::vector<MapMember> share_out(const LightSamples& samples, std::span<const uint32_t> center,
                                 std::span<const std::vector<uint32_t>> candidates, const std::stop_token& stop) {
  std::vector<std::vector<uint32_t>> near(center.size());
  for (uint32_t light = 0; light < center.size(); ++light)
    for (const uint32_t other : candidates[light])
      if (center[light] != light && center[other] == other && near[light].size() < most_candidates)
        near[light].push_back(other);

  Sharing sharing(samples, center, stop);
  const double unshared = sharing.error();
  bool moved = true;
  for (uint32_t pass = 0; moved && pass < most_passes; ++pass) {
    moved = false;
    for (uint32_t light = 0; light < center.size(); ++light) {
      stop_if_asked(stop);
      moved = sharing.improve(light, near[light]) || moved;
    }
  }
  for (uint32_t light = 0; light < center.size(); ++light) {
    stop_if_asked(stop);
    sharing.tidy(light);
  }

  std::vector<MapMember> members;
  const bool pays = sharing.error() < unshared;
  for (uint32_t light = 0; light < center.size(); ++light) {
    if (!pays) members.push_back({light, center[light], 0.0f});
    for (const Share& share : sharing.shares(light))
      if (pays) members.push_back({light, share.center, 0.0f, share.part});
  }
  std::sort(members.begin(), members.end(), [](const MapMember& a, const MapMember& b) {
    return a.center != b.center ? a.center < b.center : a.light < b.light;
  });
  return members;
}

}  // namespace chandelier
