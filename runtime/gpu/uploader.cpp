// SPDX-License-Identifier: Apache-2.0
#include "gpu/uploader.h"

#include <volk.h>

#include <algorithm>
#include <utility>

namespace chandelier::gpu {
namespace {

// Staged at a time: what a large scene takes twice while it is uploaded.
constexpr uint64_t most_staged_bytes = uint64_t{256} << 20;

constexpr ImageUse nothing_yet{VK_IMAGE_LAYOUT_UNDEFINED, VK_PIPELINE_STAGE_2_NONE, VK_ACCESS_2_NONE};
constexpr ImageUse copied_to{VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, VK_PIPELINE_STAGE_2_COPY_BIT,
                             VK_ACCESS_2_TRANSFER_WRITE_BIT};
constexpr ImageUse read_by_fragments{VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL, VK_PIPELINE_STAGE_2_FRAGMENT_SHADER_BIT,
                                     VK_ACCESS_2_SHADER_SAMPLED_READ_BIT};

}  // namespace

Uploader::Uploader(const Device& device, uint64_t all_bytes, UploadProgress progress)
    : device_(device), all_bytes_(all_bytes), progress_(std::move(progress)) {}

Uploader::~Uploader() {
  if (handle_) device_->vkFreeCommandBuffers(device_.handle, device_.command_pool, 1, &handle_);
}

Commands Uploader::commands() {
  if (!handle_) {
    const VkCommandBufferAllocateInfo info{.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO,
                                           .commandPool = device_.command_pool,
                                           .level = VK_COMMAND_BUFFER_LEVEL_PRIMARY,
                                           .commandBufferCount = 1};
    check(device_->vkAllocateCommandBuffers(device_.handle, &info, &handle_), "vkAllocateCommandBuffers");
    const VkCommandBufferBeginInfo begin{.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO,
                                         .flags = VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT};
    check(device_->vkBeginCommandBuffer(handle_, &begin), "vkBeginCommandBuffer");
  }
  return {device_, handle_};
}

// The last of staging_, filled by the caller.
std::span<std::byte> Uploader::stage(VkDeviceSize bytes) {
  if (staged_bytes_ > 0 && staged_bytes_ + bytes > most_staged_bytes) flush();
  staging_.push_back(make_buffer(device_, bytes, VK_BUFFER_USAGE_TRANSFER_SRC_BIT, Memory::upload));
  staged_bytes_ += bytes;
  return {staging_.back().mapped, bytes};
}

Buffer Uploader::buffer(std::span<const std::byte> bytes, VkBufferUsageFlags usage) {
  Buffer made = make_buffer(device_, bytes.size(), usage | VK_BUFFER_USAGE_TRANSFER_DST_BIT, Memory::device);
  if (bytes.empty()) return made;
  std::ranges::copy(bytes, stage(bytes.size()).begin());
  const Commands cmd = commands();
  const VkBufferCopy region{.size = bytes.size()};
  cmd->vkCmdCopyBuffer(cmd, staging_.back().handle, made.handle, 1, &region);
  return made;
}

void Uploader::image(const Image& to, std::span<const std::byte> bytes, std::span<const VkBufferImageCopy> copies) {
  std::ranges::copy(bytes, stage(bytes.size()).begin());
  const Commands cmd = commands();
  image_barrier(cmd, to, nothing_yet, copied_to);
  cmd->vkCmdCopyBufferToImage(cmd, staging_.back().handle, to.handle, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL,
                              static_cast<uint32_t>(copies.size()), copies.data());
  image_barrier(cmd, to, copied_to, read_by_fragments);
}

void Uploader::flush() {
  if (!handle_) return;
  const Commands cmd = commands();
  memory_barrier(cmd, VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT, VK_ACCESS_2_TRANSFER_WRITE_BIT,
                 VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT, VK_ACCESS_2_MEMORY_READ_BIT | VK_ACCESS_2_MEMORY_WRITE_BIT);
  submit_and_wait(device_, handle_);
  device_->vkFreeCommandBuffers(device_.handle, device_.command_pool, 1, &handle_);
  handle_ = VK_NULL_HANDLE;
  staging_.clear();
  done_bytes_ += std::exchange(staged_bytes_, 0);
  if (progress_) progress_(std::min(done_bytes_, all_bytes_), all_bytes_);
}

void Uploader::finish() {
  flush();
  if (progress_ && done_bytes_ < all_bytes_) progress_(all_bytes_, all_bytes_);
}

}  // namespace chandelier::gpu
