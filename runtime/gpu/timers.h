// SPDX-License-Identifier: Apache-2.0
// GPU timestamps around the stages of one frame, and the CPU's time beside them.
#pragma once

#include <chrono>
#include <span>
#include <vector>

#include "gpu/frames.h"

namespace chandelier::gpu {

/// A stage may be entered several times in a frame: its times add up. Names must outlive the timers.
class Timers {
 public:
  explicit Timers(const Device& device);

  /// Makes room for `spans` begin-end pairs. The frame that was timed before must have finished.
  void start_frame(Commands cmd, uint32_t spans);
  void begin(Commands cmd, const char* stage);
  void end(Commands cmd);
  /// Time that a stage took on the CPU alone.
  void add_cpu(const char* stage, double cpu_ms);

  struct Stage {
    const char* name;
    double gpu_ms = 0.0;
    double cpu_ms = 0.0;
  };
  /// In the order in which stages first began. Does not wait: throws Error where the frame has not finished.
  std::span<const Stage> read();

 private:
  struct Span {
    size_t stage;
    uint32_t first_query;
  };
  size_t stage_number(const char* name);

  const Device* device_;
  Owned<VkQueryPool> pool_;
  double ms_per_tick_;
  uint64_t valid_bits_;
  uint32_t room_ = 0;  // queries of the pool
  uint32_t used_ = 0;
  bool is_read_ = false;
  std::vector<Stage> stages_;
  std::vector<Span> spans_;
  std::vector<uint64_t> ticks_;
  std::chrono::steady_clock::time_point begun_;
};

}  // namespace chandelier::gpu
