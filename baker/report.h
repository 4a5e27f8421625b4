// SPDX-License-Identifier: Apache-2.0
// What a bake did: each pass with its time and counts. `--json` prints it; the benchmarks read that.
#pragma once

#include <chrono>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "progress.h"

namespace chandelier::baker {

/// One pass. It chooses its counts and their order: "triangles", "shells", "sah_cost", …
struct PassReport {
  std::string name;
  double ms = 0;       // wall time
  uint64_t bytes = 0;  // that it put into the pack
  std::vector<std::pair<std::string, double>> counts;
  bool cached = false;  // it did not run: its result came from the cache

  void count(const std::string& what, double value) { counts.emplace_back(what, value); }
};

struct Report {
  const Progress* progress = nullptr;  // told of each pass
  std::vector<PassReport> passes;

  /// Runs `work(pass)` and notes how long it took.
  template <typename Work>
  void run(const std::string& name, Work work) {
    PassReport pass;
    pass.name = name;
    if (progress) progress->begin(name);
    const auto start = std::chrono::steady_clock::now();
    work(pass);
    pass.ms = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
    if (progress) progress->end(name, pass.ms);
    passes.push_back(std::move(pass));
  }
};

}  // namespace chandelier::baker
