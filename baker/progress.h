// SPDX-License-Identifier: Apache-2.0
// Lines on stderr that tell someone who waits at a terminal what the bake is doing.
#pragma once

#include <chrono>
#include <cstdio>
#include <string>

namespace chandelier::baker {

class Progress {
 public:
  explicit Progress(bool shown) : shown_(shown) {}

  double seconds() const { return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count(); }

  /// Says what comes next, unless the bake has been too short for anyone to wonder.
  void next(const std::string& what) const {
    constexpr double kPatience_s = 1.0;
    if (shown_ && seconds() > kPatience_s)
      std::fprintf(stderr, "chandelier-bake: %.1f s: %s\n", seconds(), what.c_str());
  }

 private:
  bool shown_;
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

}  // namespace chandelier::baker
