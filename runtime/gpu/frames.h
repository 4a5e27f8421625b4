// SPDX-License-Identifier: Apache-2.0
// Frames in flight: while the device works on one, the CPU records the next. A slot holds what one of them needs for
// itself.
#pragma once

#include <algorithm>
#include <initializer_list>
#include <memory>
#include <span>
#include <vector>

#include "gpu/resources.h"

namespace chandelier::gpu {

/// Memory for what the CPU writes in one frame and the device copies from. Grows to the largest frame so far.
class UploadArena {
 public:
  explicit UploadArena(const Device& device) : device_(&device) {}

  struct Piece {
    VkBuffer buffer;
    VkDeviceSize offset;
    std::byte* mapped;
  };
  /// Room for `bytes`, until reset(). Throws Error.
  Piece take(VkDeviceSize bytes);
  /// The device has finished with all pieces.
  void reset();

 private:
  const Device* device_;
  std::vector<Buffer> full_;  // still read by the device; one of twice their size follows
  Buffer current_;
  VkDeviceSize used_ = 0;
};

/// Resources that frames on their way may still use: kept until their slot comes round again.
class Retired {
 public:
  template <typename T>
  void add(T&& resource) {
    held_.push_back(std::make_shared<std::decay_t<T>>(std::forward<T>(resource)));
  }
  void clear() { held_.clear(); }

 private:
  std::vector<std::shared_ptr<void>> held_;
};

/// A size for a buffer that must hold `needed` and holds `current`: it grows by half at least, so that a list that
/// grows step by step is seldom moved.
constexpr VkDeviceSize grown(VkDeviceSize needed, VkDeviceSize current) {
  return std::max(needed, current + current / 2);
}

/// A device buffer that the CPU fills anew in every frame.
class Streamed {
 public:
  const Buffer& buffer() const { return buffer_; }
  /// Copies `parts`, one after the other, by commands of this frame; shaders may read after a barrier from
  /// ALL_TRANSFER.
  template <typename T>
  void write(const Device& device, Commands cmd, UploadArena& arena, Retired& retired,
             std::initializer_list<std::span<const T>> parts) {
    VkDeviceSize bytes = 0;
    for (const auto& part : parts) bytes += part.size_bytes();
    std::byte* to = begin_write(device, cmd, arena, retired, bytes);
    for (const auto& part : parts) to = std::ranges::copy(std::as_bytes(part), to).out;
  }

 private:
  std::byte* begin_write(const Device& device, Commands cmd, UploadArena& arena, Retired& retired, VkDeviceSize bytes);

  Buffer buffer_;
};

/// Command buffers and fences for a program that has no frame loop of its own.
class FrameRing {
 public:
  FrameRing(const Device& device, uint32_t slots);
  ~FrameRing();
  FrameRing(const FrameRing&) = delete;
  FrameRing& operator=(const FrameRing&) = delete;

  /// The next slot, in turns. Waits until the device has finished what was submitted from it before.
  uint32_t next();
  /// Begins the commands of a slot that next() returned.
  Commands begin(uint32_t slot);
  /// Ends and submits them. `wait` is waited for before anything that blits or copies to the window's image.
  void submit(uint32_t slot, VkSemaphore wait = VK_NULL_HANDLE, VkSemaphore signal = VK_NULL_HANDLE);
  /// Until the device has finished the slot's commands.
  void wait(uint32_t slot) const;
  bool is_finished(uint32_t slot) const;
  void wait_for_all() const;
  uint32_t slot_count() const { return static_cast<uint32_t>(slots_.size()); }

 private:
  struct Slot {
    VkCommandBuffer commands = VK_NULL_HANDLE;
    Owned<VkFence> finished;
    bool is_submitted = false;  // else its fence is signalled by nothing
  };
  const Device& device_;
  std::vector<Slot> slots_;
  uint32_t next_ = 0;
};

}  // namespace chandelier::gpu
