// SPDX-License-Identifier: Apache-2.0
#include "gpu/frames.h"

#include <volk.h>

#include <utility>

namespace chandelier::gpu {
namespace {

constexpr VkDeviceSize first_arena_bytes = VkDeviceSize{64} << 10;
constexpr VkDeviceSize piece_alignment = 16;

}  // namespace

UploadArena::Piece UploadArena::take(VkDeviceSize bytes) {
  const VkDeviceSize offset = (used_ + piece_alignment - 1) / piece_alignment * piece_alignment;
  if (!current_.handle || offset + bytes > current_.size_bytes) {
    const VkDeviceSize size = std::max({first_arena_bytes, 2 * bytes, 2 * current_.size_bytes});
    Buffer larger = make_buffer(*device_, size, VK_BUFFER_USAGE_TRANSFER_SRC_BIT, Memory::upload);
    if (current_.handle) full_.push_back(std::move(current_));
    current_ = std::move(larger);
    used_ = bytes;
    return {current_.handle, 0, current_.mapped};
  }
  used_ = offset + bytes;
  return {current_.handle, offset, current_.mapped + offset};
}

void UploadArena::reset() {
  full_.clear();
  used_ = 0;
}

std::byte* Streamed::begin_write(const Device& device, Commands cmd, UploadArena& arena, Retired& retired,
                                 VkDeviceSize bytes) {
  if (!buffer_.handle || buffer_.size_bytes < bytes) {
    Buffer larger = make_buffer(device, grown(bytes, buffer_.size_bytes),
                                VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT, Memory::device);
    if (buffer_.handle) retired.add(std::move(buffer_));
    buffer_ = std::move(larger);
  }
  if (bytes == 0) return nullptr;
  const UploadArena::Piece piece = arena.take(bytes);
  const VkBufferCopy region{.srcOffset = piece.offset, .size = bytes};
  cmd->vkCmdCopyBuffer(cmd, piece.buffer, buffer_.handle, 1, &region);
  return piece.mapped;
}

FrameRing::FrameRing(const Device& device, uint32_t slots) : device_(device), slots_(slots) {
  for (Slot& slot : slots_) {
    const VkFenceCreateInfo info{.sType = VK_STRUCTURE_TYPE_FENCE_CREATE_INFO};
    VkFence fence = VK_NULL_HANDLE;
    check(device->vkCreateFence(device.handle, &info, nullptr, &fence), "vkCreateFence");
    slot.finished = {device.handle, fence, device->vkDestroyFence};
  }
  for (Slot& slot : slots_) {
    const VkCommandBufferAllocateInfo info{.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO,
                                           .commandPool = device.command_pool,
                                           .level = VK_COMMAND_BUFFER_LEVEL_PRIMARY,
                                           .commandBufferCount = 1};
    check(device->vkAllocateCommandBuffers(device.handle, &info, &slot.commands), "vkAllocateCommandBuffers");
  }
}

FrameRing::~FrameRing() {
  wait_for_all();
  for (const Slot& slot : slots_)
    device_->vkFreeCommandBuffers(device_.handle, device_.command_pool, 1, &slot.commands);
}

uint32_t FrameRing::next() {
  const uint32_t slot = std::exchange(next_, (next_ + 1) % slot_count());
  wait(slot);
  return slot;
}

Commands FrameRing::begin(uint32_t slot) {
  const VkCommandBufferBeginInfo begin{.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO,
                                       .flags = VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT};
  // It may still be recording, where something threw after the last begin().
  check(device_->vkResetCommandBuffer(slots_[slot].commands, 0), "vkResetCommandBuffer");
  check(device_->vkBeginCommandBuffer(slots_[slot].commands, &begin), "vkBeginCommandBuffer");
  return {device_, slots_[slot].commands};
}

void FrameRing::submit(uint32_t slot, VkSemaphore wait, VkSemaphore signal) {
  Slot& of = slots_[slot];
  check(device_->vkEndCommandBuffer(of.commands), "vkEndCommandBuffer");
  const VkSemaphoreSubmitInfo waited{.sType = VK_STRUCTURE_TYPE_SEMAPHORE_SUBMIT_INFO,
                                     .semaphore = wait,
                                     .stageMask = VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT};
  const VkSemaphoreSubmitInfo signalled{.sType = VK_STRUCTURE_TYPE_SEMAPHORE_SUBMIT_INFO,
                                        .semaphore = signal,
                                        .stageMask = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT};
  const VkCommandBufferSubmitInfo commands{.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_SUBMIT_INFO,
                                           .commandBuffer = of.commands};
  const VkSubmitInfo2 info{.sType = VK_STRUCTURE_TYPE_SUBMIT_INFO_2,
                           .waitSemaphoreInfoCount = wait ? 1u : 0u,
                           .pWaitSemaphoreInfos = &waited,
                           .commandBufferInfoCount = 1,
                           .pCommandBufferInfos = &commands,
                           .signalSemaphoreInfoCount = signal ? 1u : 0u,
                           .pSignalSemaphoreInfos = &signalled};
  of.is_submitted = false;
  check(device_->vkResetFences(device_.handle, 1, of.finished.address()), "vkResetFences");
  check(device_->vkQueueSubmit2(device_.queue, 1, &info, of.finished), "vkQueueSubmit2");
  of.is_submitted = true;
}

void FrameRing::wait(uint32_t slot) const {
  if (!slots_[slot].is_submitted) return;
  check(device_->vkWaitForFences(device_.handle, 1, slots_[slot].finished.address(), VK_TRUE, UINT64_MAX),
        "vkWaitForFences");
}

bool FrameRing::is_finished(uint32_t slot) const {
  return !slots_[slot].is_submitted || device_->vkGetFenceStatus(device_.handle, slots_[slot].finished) == VK_SUCCESS;
}

void FrameRing::wait_for_all() const {
  for (const Slot& slot : slots_)
    if (slot.is_submitted) device_->vkWaitForFences(device_.handle, 1, slot.finished.address(), VK_TRUE, UINT64_MAX);
}

}  // namespace chandelier::gpu
