// SPDX-License-Identifier: Apache-2.0
// Ranges of a block: never outside, never twice, and whole again in the end.
#include "gpu/ranges.h"

#include <gtest/gtest.h>

#include <random>
#include <vector>

namespace chandelier::gpu {
namespace {

TEST(RangesTest, RandomRangesNeverOverlapAndBecomeOneGapAgain) {
  constexpr uint64_t size = 4096;
  std::mt19937 random(7);
  Ranges ranges(size);
  struct Taken {
    uint64_t offset, size;
  };
  std::vector<Taken> taken;
  std::vector<bool> used(size, false);
  uint32_t refused = 0;
  for (int step = 0; step < 20000; ++step) {
    if (taken.empty() || random() % 2) {
      const uint64_t bytes = 1 + random() % 300;
      const uint64_t alignment = uint64_t{1} << random() % 8;
      const auto offset = ranges.take(bytes, alignment);
      if (!offset) {
        ++refused;
        continue;
      }
      ASSERT_EQ(*offset % alignment, 0u);
      ASSERT_LE(*offset + bytes, size);
      for (uint64_t i = *offset; i < *offset + bytes; ++i) {
        ASSERT_FALSE(used[i]);
        used[i] = true;
      }
      taken.push_back({*offset, bytes});
    } else {
      std::swap(taken[random() % taken.size()], taken.back());
      for (uint64_t i = 0; i < taken.back().size; ++i) used[taken.back().offset + i] = false;
      ranges.give_back(taken.back().offset, taken.back().size);
      taken.pop_back();
    }
    ASSERT_EQ(ranges.is_empty(), taken.empty());
  }
  EXPECT_GT(refused, 0u);  // it was full at times
  for (const Taken& piece : taken) ranges.give_back(piece.offset, piece.size);
  EXPECT_TRUE(ranges.is_empty());
  EXPECT_EQ(ranges.take(size, 1), 0u);
}

}  // namespace
}  // namespace chandelier::gpu
