// SPDX-License-Identifier: Apache-2.0
// GPU timestamps around the stages of a frame, and the CPU's time beside them.
#pragma once

#include <chrono>
#include <string>
#include <vector>

#include "gpu/resources.h"

namespace chandelier::gpu {

/// A stage may be entered several times in a frame: its times add up.
class Timers {
 public:
  explicit Timers(const Device& device);

  /// Makes room for `spans` begin-end pairs.
  void start_frame(Commands cmd, uint32_t spans);
  void begin(Commands cmd, const char* stage);
  void end(Commands cmd);
  /// Time that a stage took on the CPU alone.
  void add_cpu(const char* stage, double cpu_ms);

  struct Stage {
    std::string name;
    double gpu_ms = 0.0;
    double cpu_ms = 0.0;
  };
  /// In the order in which stages first began. Call after the frame's commands have finished.
  std::vector<Stage> read();

 private:
  struct Span {
    size_t stage;
    uint32_t first_query;
  };
  size_t stage_number(const char* name);

  const Device* device_;
  Owned<VkQueryPool> pool_;
  double ms_per_tick_;
  uint32_t room_ = 0;  // queries of the pool
  uint32_t used_ = 0;
  std::vector<Stage> stages_;
  std::vector<Span> spans_;
  std::chrono::steady_clock::time_point begun_;
};

}  // namespace chandelier::gpu
