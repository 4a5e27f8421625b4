// SPDX-License-Identifier: Apache-2.0
// Device memory in large blocks, of which buffers and images take parts: drivers allow few allocations (4096 is
// common), and each is slow. Our own, because no package of Debian 12 has the VulkanMemoryAllocator.
#pragma once

#include <vulkan/vulkan_core.h>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>
#include <vector>

#include "gpu/ranges.h"

namespace chandelier::gpu {

class Allocator;
class Device;

/// Where a buffer lives: `device` for what only shaders touch, `upload` and `readback` are mapped.
enum class Memory { device, upload, readback };

struct Block;

/// A part of a block. Gives itself back when it ends.
class Allocation {
 public:
  Allocation() = default;
  Allocation(Allocator& from, Block& block, VkDeviceSize offset, VkDeviceSize size)
      : from_(&from), block_(&block), offset_(offset), size_(size) {}
  Allocation(Allocation&& o) noexcept { swap(o); }
  Allocation& operator=(Allocation&& o) noexcept {
    swap(o);
    return *this;
  }
  ~Allocation();

  VkDeviceMemory memory() const;
  VkDeviceSize offset() const { return offset_; }
  std::byte* mapped() const;  // coherent; null for Memory::device

 private:
  void swap(Allocation& o) noexcept;

  Allocator* from_ = nullptr;
  Block* block_ = nullptr;
  VkDeviceSize offset_ = 0;
  VkDeviceSize size_ = 0;
};

/// May be used by several threads.
class Allocator {
 public:
  explicit Allocator(const Device& device);
  ~Allocator();
  Allocator(const Allocator&) = delete;
  Allocator& operator=(const Allocator&) = delete;

  /// Throws Error naming `what` where there is no such memory. Images do not share blocks with buffers, so that
  /// bufferImageGranularity never matters.
  Allocation allocate(const VkMemoryRequirements& needs, Memory where, bool is_image, const char* what);

  /// Blocks held now, each a VkDeviceMemory.
  size_t block_count() const;

 private:
  friend class Allocation;
  Block& add_block(uint32_t type, VkDeviceSize size, bool is_image, bool is_mapped, bool is_shared, const char* what);
  void give_back(Block& block, VkDeviceSize offset, VkDeviceSize size);
  void free_block(Block& block);

  const Device& device_;
  mutable std::mutex lock_;
  std::vector<std::unique_ptr<Block>> blocks_;
};

}  // namespace chandelier::gpu
