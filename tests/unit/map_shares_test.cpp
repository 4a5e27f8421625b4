// SPDX-License-Identifier: Apache-2.0
// Lights in several shadow maps at once.
#include "lights/map_shares.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "sampled_scene.h"

namespace chandelier {
namespace {

using test::divided_floor;
using test::pillars;
using test::Sampled;
using test::shares_of;

// A lamp over the wall sees both sides, the two that have maps one side each. With pictures so dark that the tone curve
// is nearly straight, the squared error of a share a is a² Σ w² on the right and (1 - a)² Σ w² on the left.
TEST(MapSharesTest, TwoHalfBlindMapsShareALightAsTheSquaresSay) {
  test::Scene scene = divided_floor();
  scene.lights = {test::point_light({-1, 1.5f, 0}, 0.01f, 20), test::point_light({1, 1.5f, 0}, 0.01f, 20),
                  test::point_light({0, 30, 0}, 500, 1000)};
  const Sampled s(scene, {.exposure_ev = -8.0f});
  double left = 0.0, right = 0.0;
  for (const auto& contribution : s.samples->contributions(2)) {
    const bool is_left = s.samples->sees(0, contribution.point), is_right = s.samples->sees(1, contribution.point);
    const double w = contribution.radiance.x;
    if (is_left != is_right) (is_left ? left : right) += w * w;
  }
  const std::vector<uint32_t> center{0, 1, 0};
  const std::vector<std::vector<uint32_t>> candidates{{1, 2}, {0, 2}, {0, 1}};
  const auto members = share_out(*s.samples, center, candidates);
  ASSERT_EQ(members.size(), 4u);
  EXPECT_EQ(members[1].light, 2u);
  EXPECT_NEAR(members[1].share, left / (left + right), 0.03);
  EXPECT_NEAR(members[1].share + members[3].share, 1.0f, 1e-5f);
  const double whole = s.rmse({{0, 0, 0}, {2, 0, 0}, {1, 1, 0}});
  EXPECT_NEAR(s.rmse(members) / whole, std::sqrt(left / (left + right)), 0.03);
}

TEST(MapSharesTest, ErrNoMoreThanOneMapForEachLightAndAddUp) {
  uint32_t shared = 0;
  for (uint32_t seed = 0; seed < 6; ++seed) {
    const Sampled s(pillars(seed));
    std::vector<uint32_t> center;
    std::vector<std::vector<uint32_t>> candidates(24);
    std::vector<MapMember> whole;
    for (uint32_t light = 0; light < 24; ++light) {
      center.push_back(light % (3 + seed));
      whole.push_back({light, center.back(), 0.0f});
      for (uint32_t other = 0; other < 24; ++other)
        if (other != light && (light + other) % 5 != 0) candidates[light].push_back(other);
    }
    std::stable_sort(whole.begin(), whole.end(),
                     [](const MapMember& a, const MapMember& b) { return a.center < b.center; });
    const auto members = share_out(*s.samples, center, candidates);
    EXPECT_LT(s.rmse(members), 0.97 * s.rmse(whole)) << seed;
    for (const auto& [light, sum] : shares_of(members)) EXPECT_NEAR(sum, 1.0f, 1e-4f);
    for (const MapMember& m : members) {
      EXPECT_EQ(center[m.center], m.center);
      EXPECT_TRUE(m.light != center[m.light] || m.share == 1.0f) << "a light keeps its own map";
      EXPECT_TRUE(m.center == center[m.light] || (m.light + m.center) % 5 != 0) << "no lender";
      EXPECT_GE(m.share, 0.05f);
    }
    shared += static_cast<uint32_t>(members.size() - 24);
  }
  EXPECT_GT(shared, 20u);
}

// Of one light alone, whose shares no other's can make up for: in none of its maps it does nearly as well whole.
TEST(MapSharesTest, AreWorthMoreThanTheBestOfTheirMapsAlone) {
  uint32_t shared = 0;
  for (uint32_t seed = 0; seed < 6; ++seed) {
    const Sampled s(pillars(seed));
    for (uint32_t light = 4; light < 24; ++light) {
      std::vector<uint32_t> center(24);
      std::vector<std::vector<uint32_t>> candidates(24);
      std::iota(center.begin(), center.end(), 0u);
      center[light] = light % 4;
      for (uint32_t other = 0; other < 4; ++other) candidates[light].push_back(other);
      const auto members = share_out(*s.samples, center, candidates);
      const double several = s.rmse(members);
      if (several < 1e-3) continue;  // less than the tone curve's table can tell
      for (const MapMember& m : members) {
        if (m.light != light || m.share == 1.0f) continue;
        std::vector<MapMember> whole;
        for (const MapMember& each : members)
          if (each.light != light) whole.push_back(each);
        whole.push_back({light, m.center, 0.0f});
        std::stable_sort(whole.begin(), whole.end(),
                         [](const MapMember& a, const MapMember& b) { return a.center < b.center; });
        EXPECT_GT(s.rmse(whole), several) << "seed " << seed << ", light " << light << " in " << m.center;
        ++shared;
      }
    }
  }
  EXPECT_GT(shared, 20u);
}

// Where nothing casts a shadow there is nothing to gain.
TEST(MapSharesTest, LeaveLightsWholeWhoseMapIsRight) {
  test::Scene scene = divided_floor();
  scene.lights.resize(2);  // both left of the wall
  const Sampled s(scene);
  const auto members = share_out(*s.samples, std::vector<uint32_t>{0, 0}, std::vector<std::vector<uint32_t>>{{1}, {0}});
  ASSERT_EQ(members.size(), 2u);
  EXPECT_EQ(members[1].share, 1.0f);
}

}  // namespace
}  // namespace chandelier
