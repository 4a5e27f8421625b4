// SPDX-License-Identifier: Apache-2.0
// A loop in threads does each round once, in no more threads than it may.
#include "parallel.h"

#include <gtest/gtest.h>

#include <chrono>
#include <set>
#include <stdexcept>

namespace chandelier::pack::test {
namespace {

class Threads : public testing::TestWithParam<size_t> {};

TEST_P(Threads, DoEachRoundOnceAndAreNoMoreThanAllowed) {
  std::vector<int> done(200);
  std::set<std::thread::id> ids;
  std::mutex mutex;
  parallel_for(done.size(), GetParam(), [&](size_t i) {
    ++done[i];
    std::this_thread::sleep_for(std::chrono::microseconds(200));  // time for others to begin
    const std::lock_guard lock(mutex);
    ids.insert(std::this_thread::get_id());
  });
  EXPECT_EQ(done, std::vector<int>(200, 1));
  EXPECT_LE(ids.size(), GetParam());
  if (GetParam() == 1) {
    EXPECT_EQ(*ids.begin(), std::this_thread::get_id());
  }
}

INSTANTIATE_TEST_SUITE_P(Each, Threads, testing::Values(1, 2, 3, 8));

TEST(ParallelFor, ThrowsWhatARoundThrew) {
  EXPECT_THROW(parallel_for(10, 2,
                            [](size_t i) {
                              if (i == 7) throw std::runtime_error("seven");
                            }),
               std::runtime_error);
}

}  // namespace
}  // namespace chandelier::pack::test
