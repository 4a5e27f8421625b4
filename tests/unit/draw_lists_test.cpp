// SPDX-License-Identifier: Apache-2.0
// Draw lists: how the room for draws is divided, and how many passes may be needed.
#include "shadows/cull/draw_lists.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

namespace chandelier {
namespace {

std::vector<DrawList> lists_of(const std::vector<uint32_t>& sizes) {
  std::vector<DrawList> lists;
  for (const uint32_t size : sizes) lists.push_back({.batch_instances = size});
  return lists;
}

TEST(DrawListsTest, WhereAllFitsThereIsOnePass) {
  const auto lists = lists_of({100, 7, 1});
  const auto slots = divide_draws(lists, 6, 10000, UINT32_MAX);
  EXPECT_EQ(slots[0].capacity, 600u);
  EXPECT_EQ(slots[1].first, 600u);
  EXPECT_EQ(slots[2].first + slots[2].capacity, 648u);
  EXPECT_EQ(passes_at_most(lists, slots, 6), 1u);
}

TEST(DrawListsTest, NoListIsDrawnByLargerCallsThanADeviceTakes) {
  const auto lists = lists_of({100, 7});
  const auto slots = divide_draws(lists, 6, 10000, 50);
  EXPECT_EQ(slots[0].capacity, 50u);
  EXPECT_EQ(slots[1].capacity, 42u);
  EXPECT_EQ(passes_at_most(lists, slots, 6), 12u);
}

// Parts do not overlap, together they stay within the room for draws, and the passes hold whatever may come.
TEST(DrawListsTest, AnyDivisionIsSound) {
  std::mt19937 random(3);
  for (int i = 0; i < 500; ++i) {
    std::vector<uint32_t> sizes(1 + random() % 20);
    for (uint32_t& size : sizes) size = static_cast<uint32_t>(1 + random() % 500);
    const auto lists = lists_of(sizes);
    const uint64_t views = 1 + random() % 300, most = 1 + random() % 5000;
    const auto slots = divide_draws(lists, views, most, UINT32_MAX);
    const uint64_t passes = passes_at_most(lists, slots, views);
    uint64_t first = 0;
    for (size_t l = 0; l < lists.size(); ++l) {
      EXPECT_EQ(slots[l].first, first);
      EXPECT_GE(slots[l].capacity, 1u);
      EXPECT_GE(slots[l].capacity * passes, sizes[l] * views);
      first += slots[l].capacity;
    }
    EXPECT_LE(first, most + lists.size());
  }
}

// Groups have no more views than the recorded passes can draw.
TEST(DrawListsTest, AGroupsViewsFillABoundedNumberOfPasses) {
  for (const uint32_t size : {1000u, 60851u, 3000000u}) {
    const auto lists = lists_of({size});
    const uint64_t views = most_views(size, most_caster_draws);
    const auto slots = divide_draws(lists, views, most_caster_draws, UINT32_MAX);
    EXPECT_GT(views, 6u);
    EXPECT_LE(passes_at_most(lists, slots, views), most_draw_passes);
  }
}

}  // namespace
}  // namespace chandelier
