// SPDX-License-Identifier: Apache-2.0
// Runs a loop in a few threads. Not oneTBB: the portable player has only the C and C++ libraries.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <exception>
#include <mutex>
#include <system_error>
#include <thread>
#include <vector>

namespace chandelier::pack {

/// Calls `body(i)` once for each i below `count`, in any order and at the same time, in at most `most_threads` threads
/// with this one; 0: as many as there are cores. Throws what a call threw.
template <typename Body>
void parallel_for(size_t count, size_t most_threads, const Body& body) {
  std::atomic<size_t> next = 0;
  std::exception_ptr thrown;
  std::mutex mutex;
  const auto work = [&] {
    for (size_t i = next++; i < count; i = next++) {
      try {
        body(i);
      } catch (...) {
        const std::lock_guard lock(mutex);
        if (!thrown) thrown = std::current_exception();
      }
    }
  };
  std::vector<std::jthread> threads;
  const size_t wanted = std::min(count, most_threads ? most_threads : std::thread::hardware_concurrency());
  try {
    for (size_t i = 1; i < wanted; ++i) threads.emplace_back(work);
  } catch (const std::system_error&) {  // no more threads available: the existing ones do all the work
  }
  work();
  threads.clear();
  if (thrown) std::rethrow_exception(thrown);
}

}  // namespace chandelier::pack
