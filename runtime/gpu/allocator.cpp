// SPDX-License-Identifier: Apache-2.0
#include "gpu/allocator.h"

#include <volk.h>

#include <algorithm>
#include <string>
#include <utility>

#include "gpu/device.h"

namespace chandelier::gpu {

struct Block {
  VkDeviceMemory memory;
  uint32_t type;
  bool is_image;
  bool is_shared;  // may hold several resources; else one, of its own size
  std::byte* mapped;
  Ranges ranges;
};

namespace {

constexpr VkDeviceSize largest_block = VkDeviceSize{64} << 20;

VkMemoryPropertyFlags properties_of(Memory where) {
  switch (where) {
    case Memory::device:
      return VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT;
    case Memory::upload:
      return VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT;
    case Memory::readback:
      return VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT |
             VK_MEMORY_PROPERTY_HOST_CACHED_BIT;
  }
  return 0;
}

uint32_t find_type(const Device& device, uint32_t allowed, VkMemoryPropertyFlags wanted, const char* what) {
  for (uint32_t i = 0; i < device.memory.memoryTypeCount; ++i)
    if ((allowed >> i & 1u) && (device.memory.memoryTypes[i].propertyFlags & wanted) == wanted) return i;
  if (wanted & VK_MEMORY_PROPERTY_HOST_CACHED_BIT)  // which a device need not have together with the others
    return find_type(device, allowed, wanted & ~VkMemoryPropertyFlags{VK_MEMORY_PROPERTY_HOST_CACHED_BIT}, what);
  throw Error(std::string("no memory type for ") + what);
}

// A small heap, such as the window of a GPU's memory that the CPU sees, is taken in small blocks.
VkDeviceSize block_size(const Device& device, uint32_t type) {
  const VkDeviceSize heap = device.memory.memoryHeaps[device.memory.memoryTypes[type].heapIndex].size;
  return std::min(largest_block, heap / 32);
}

}  // namespace

Allocation::~Allocation() {
  if (from_) from_->give_back(*block_, offset_, size_);
}

VkDeviceMemory Allocation::memory() const {
  return block_ ? block_->memory : VK_NULL_HANDLE;
}

std::byte* Allocation::mapped() const {
  return block_ && block_->mapped ? block_->mapped + offset_ : nullptr;
}

void Allocation::swap(Allocation& o) noexcept {
  std::swap(from_, o.from_);
  std::swap(block_, o.block_);
  std::swap(offset_, o.offset_);
  std::swap(size_, o.size_);
}

Allocator::Allocator(const Device& device) : device_(device) {}

Allocator::~Allocator() {
  while (!blocks_.empty()) free_block(*blocks_.back());
}

Allocation Allocator::allocate(const VkMemoryRequirements& needs, Memory where, bool is_image, const char* what) {
  const std::lock_guard lock(lock_);
  const uint32_t type = find_type(device_, needs.memoryTypeBits, properties_of(where), what);
  const bool is_mapped = where != Memory::device;
  const VkDeviceSize shared_size = block_size(device_, type);
  const bool is_shared = needs.size <= shared_size / 4;
  if (is_shared) {
    for (const auto& block : blocks_) {
      const bool fits = block->is_shared && block->type == type && block->is_image == is_image &&
                        (block->mapped != nullptr) == is_mapped;
      if (!fits) continue;
      if (const auto offset = block->ranges.take(needs.size, needs.alignment))
        return {*this, *block, *offset, needs.size};
    }
  }
  Block& block = add_block(type, is_shared ? shared_size : needs.size, is_image, is_mapped, is_shared, what);
  return {*this, block, block.ranges.take(needs.size, needs.alignment).value(), needs.size};
}

size_t Allocator::block_count() const {
  const std::lock_guard lock(lock_);
  return blocks_.size();
}

Block& Allocator::add_block(uint32_t type, VkDeviceSize size, bool is_image, bool is_mapped, bool is_shared,
                            const char* what) {
  blocks_.reserve(blocks_.size() + 1);
  auto block = std::make_unique<Block>(Block{VK_NULL_HANDLE, type, is_image, is_shared, nullptr, Ranges(size)});
  const VkMemoryAllocateInfo info{
      .sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO, .allocationSize = size, .memoryTypeIndex = type};
  if (device_->vkAllocateMemory(device_.handle, &info, nullptr, &block->memory) < 0)
    throw Error("out of memory for " + std::string(what) + " (" + std::to_string(size) + " bytes)");
  blocks_.push_back(std::move(block));
  Block& added = *blocks_.back();
  if (!is_mapped) return added;
  void* mapped = nullptr;
  if (device_->vkMapMemory(device_.handle, added.memory, 0, VK_WHOLE_SIZE, 0, &mapped) < 0) {
    free_block(added);
    throw Error("cannot map memory for " + std::string(what) + " (" + std::to_string(size) + " bytes)");
  }
  added.mapped = static_cast<std::byte*>(mapped);
  return added;
}

void Allocator::give_back(Block& block, VkDeviceSize offset, VkDeviceSize size) {
  const std::lock_guard lock(lock_);
  block.ranges.give_back(offset, size);
  if (block.ranges.is_empty()) free_block(block);
}

void Allocator::free_block(Block& block) {
  device_->vkFreeMemory(device_.handle, block.memory, nullptr);
  std::erase_if(blocks_, [&](const auto& held) { return held.get() == &block; });
}

}  // namespace chandelier::gpu
