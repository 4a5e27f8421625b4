// SPDX-License-Identifier: Apache-2.0
#include "gpu/timers.h"

#include <volk.h>

#include <cstring>
#include <utility>

namespace chandelier::gpu {
Timers::Timers(const Device& device)
    : device_(&device),
      ms_per_tick_(device.limits.timestampPeriod * 1e-6),
      valid_bits_(device.timestamp_bits >= 64 ? UINT64_MAX : (uint64_t{1} << device.timestamp_bits) - 1) {}

void Timers::start_frame(Commands cmd, uint32_t spans) {
  if (room_ < 2 * spans) {
    room_ = static_cast<uint32_t>(grown(2 * spans, room_));
    const VkQueryPoolCreateInfo info{
        .sType = VK_STRUCTURE_TYPE_QUERY_POOL_CREATE_INFO, .queryType = VK_QUERY_TYPE_TIMESTAMP, .queryCount = room_};
    VkQueryPool pool = VK_NULL_HANDLE;
    check((*device_)->vkCreateQueryPool(device_->handle, &info, nullptr, &pool), "vkCreateQueryPool");
    pool_ = {device_->handle, pool, (*device_)->vkDestroyQueryPool};
  }
  stages_.clear();
  spans_.clear();
  used_ = 0;
  is_read_ = false;
  cmd->vkCmdResetQueryPool(cmd, pool_, 0, room_);
}

size_t Timers::stage_number(const char* name) {
  for (size_t i = 0; i < stages_.size(); ++i)
    if (!std::strcmp(stages_[i].name, name)) return i;
  stages_.push_back({name});
  return stages_.size() - 1;
}

void Timers::begin(Commands cmd, const char* stage) {
  if (used_ + 2 > room_) throw Error("more timed spans than announced");
  spans_.push_back({stage_number(stage), used_});
  cmd->vkCmdWriteTimestamp2(cmd, VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT, pool_, used_);
  used_ += 2;
  begun_ = std::chrono::steady_clock::now();
}

void Timers::end(Commands cmd) {
  const Span& span = spans_.back();
  stages_[span.stage].cpu_ms +=
      std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begun_).count();
  cmd->vkCmdWriteTimestamp2(cmd, VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT, pool_, span.first_query + 1);
}

void Timers::add_cpu(const char* stage, double cpu_ms) {
  stages_[stage_number(stage)].cpu_ms += cpu_ms;
}

std::span<const Timers::Stage> Timers::read() {
  if (is_read_ || used_ == 0) return stages_;
  ticks_.resize(used_);
  const VkResult result = (*device_)->vkGetQueryPoolResults(device_->handle, pool_, 0, used_, ticks_.size() * 8,
                                                            ticks_.data(), 8, VK_QUERY_RESULT_64_BIT);
  if (result == VK_NOT_READY) throw Error("a frame's times were asked for before the device had finished it");
  check(result, "vkGetQueryPoolResults");
  is_read_ = true;
  // A timestamp has so many valid bits and wraps around: so does the difference.
  for (const Span& span : spans_)
    stages_[span.stage].gpu_ms +=
        static_cast<double>((ticks_[span.first_query + 1] - ticks_[span.first_query]) & valid_bits_) * ms_per_tick_;
  return stages_;
}

}  // namespace chandelier::gpu
