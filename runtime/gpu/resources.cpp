// SPDX-License-Identifier: Apache-2.0
#include "gpu/resources.h"

#include <volk.h>

#include <algorithm>
#include <cstring>

namespace chandelier::gpu {
namespace {

bool has_depth(VkFormat format) {
  return format == VK_FORMAT_D32_SFLOAT || format == VK_FORMAT_D16_UNORM;
}

}  // namespace

Buffer make_buffer(const Device& device, VkDeviceSize size_bytes, VkBufferUsageFlags usage, Memory where) {
  Buffer buffer;
  buffer.size_bytes = std::max<VkDeviceSize>(size_bytes, 64);
  const VkBufferCreateInfo info{
      .sType = VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO, .size = buffer.size_bytes, .usage = usage};
  VkBuffer handle = VK_NULL_HANDLE;
  check(device->vkCreateBuffer(device.handle, &info, nullptr, &handle), "vkCreateBuffer");
  buffer.handle = {device.handle, handle, device->vkDestroyBuffer};
  VkMemoryRequirements needs;
  device->vkGetBufferMemoryRequirements(device.handle, handle, &needs);
  buffer.memory = device.allocator().allocate(needs, where, false, "a buffer");
  buffer.mapped = buffer.memory.mapped();
  check(device->vkBindBufferMemory(device.handle, handle, buffer.memory.memory(), buffer.memory.offset()),
        "vkBindBufferMemory");
  return buffer;
}

Image make_image(const Device& device, const ImageInfo& info) {
  Image image;
  image.info = info;
  image.aspect = has_depth(info.format) ? VK_IMAGE_ASPECT_DEPTH_BIT : VK_IMAGE_ASPECT_COLOR_BIT;
  const VkImageCreateInfo create{.sType = VK_STRUCTURE_TYPE_IMAGE_CREATE_INFO,
                                 .flags = info.flags,
                                 .imageType = VK_IMAGE_TYPE_2D,
                                 .format = info.format,
                                 .extent = {info.width, info.height, 1},
                                 .mipLevels = info.levels,
                                 .arrayLayers = info.layers,
                                 .samples = static_cast<VkSampleCountFlagBits>(info.samples),
                                 .tiling = VK_IMAGE_TILING_OPTIMAL,
                                 .usage = info.usage};
  VkImage handle = VK_NULL_HANDLE;
  check(device->vkCreateImage(device.handle, &create, nullptr, &handle), "vkCreateImage");
  image.handle = {device.handle, handle, device->vkDestroyImage};
  VkMemoryRequirements needs;
  device->vkGetImageMemoryRequirements(device.handle, handle, &needs);
  image.size_bytes = needs.size;
  image.memory = device.allocator().allocate(needs, Memory::device, true, "an image");
  check(device->vkBindImageMemory(device.handle, handle, image.memory.memory(), image.memory.offset()),
        "vkBindImageMemory");
  image.view = make_view(device, image, info.view_type, 0, info.layers);
  return image;
}

bool can_have_samples(const Device& device, VkFormat format, VkImageUsageFlags usage, uint32_t samples) {
  VkImageFormatProperties properties{};
  const VkResult result = device.instance_functions().vkGetPhysicalDeviceImageFormatProperties(
      device.physical, format, VK_IMAGE_TYPE_2D, VK_IMAGE_TILING_OPTIMAL, usage, 0, &properties);
  return result == VK_SUCCESS && (properties.sampleCounts & samples) != 0;
}

Owned<VkImageView> make_view(const Device& device, const Image& image, VkImageViewType type, uint32_t first_layer,
                             uint32_t layer_count) {
  const VkImageViewCreateInfo info{.sType = VK_STRUCTURE_TYPE_IMAGE_VIEW_CREATE_INFO,
                                   .image = image.handle,
                                   .viewType = type,
                                   .format = image.info.format,
                                   .subresourceRange = {image.aspect, 0, image.info.levels, first_layer, layer_count}};
  VkImageView view = VK_NULL_HANDLE;
  check(device->vkCreateImageView(device.handle, &info, nullptr, &view), "vkCreateImageView");
  return {device.handle, view, device->vkDestroyImageView};
}

Owned<VkSampler> make_sampler(const Device& device, const VkSamplerCreateInfo& info) {
  VkSampler sampler = VK_NULL_HANDLE;
  check(device->vkCreateSampler(device.handle, &info, nullptr, &sampler), "vkCreateSampler");
  return {device.handle, sampler, device->vkDestroySampler};
}

Owned<VkSampler> make_texel_sampler(const Device& device) {
  return make_sampler(device, {.sType = VK_STRUCTURE_TYPE_SAMPLER_CREATE_INFO,
                               .addressModeU = VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE,
                               .addressModeV = VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE,
                               .addressModeW = VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE});
}

void run_once(const Device& device, const std::function<void(Commands)>& record) {
  const VkCommandBufferAllocateInfo allocate_info{.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO,
                                                  .commandPool = device.command_pool,
                                                  .level = VK_COMMAND_BUFFER_LEVEL_PRIMARY,
                                                  .commandBufferCount = 1};
  VkCommandBuffer handle = VK_NULL_HANDLE;
  check(device->vkAllocateCommandBuffers(device.handle, &allocate_info, &handle), "vkAllocateCommandBuffers");
  struct Free {
    const Device& device;
    VkCommandBuffer handle;
    ~Free() { device->vkFreeCommandBuffers(device.handle, device.command_pool, 1, &handle); }
  } free{device, handle};
  const Commands cmd(device, handle);
  const VkCommandBufferBeginInfo begin{.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO,
                                       .flags = VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT};
  check(cmd->vkBeginCommandBuffer(cmd, &begin), "vkBeginCommandBuffer");
  record(cmd);
  submit_and_wait(device, handle);
}

void submit_and_wait(const Device& device, VkCommandBuffer commands) {
  check(device->vkEndCommandBuffer(commands), "vkEndCommandBuffer");
  const VkCommandBufferSubmitInfo submitted{.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_SUBMIT_INFO,
                                            .commandBuffer = commands};
  const VkSubmitInfo2 submit{
      .sType = VK_STRUCTURE_TYPE_SUBMIT_INFO_2, .commandBufferInfoCount = 1, .pCommandBufferInfos = &submitted};
  check(device->vkQueueSubmit2(device.queue, 1, &submit, VK_NULL_HANDLE), "vkQueueSubmit2");
  check(device->vkQueueWaitIdle(device.queue), "vkQueueWaitIdle");
}

Buffer upload_buffer(const Device& device, std::span<const std::byte> bytes, VkBufferUsageFlags usage) {
  Buffer staging = make_buffer(device, bytes.size(), VK_BUFFER_USAGE_TRANSFER_SRC_BIT, Memory::upload);
  std::copy(bytes.begin(), bytes.end(), staging.mapped);
  Buffer buffer = make_buffer(device, bytes.size(), usage | VK_BUFFER_USAGE_TRANSFER_DST_BIT, Memory::device);
  if (bytes.empty()) return buffer;
  run_once(device, [&](Commands cmd) {
    const VkBufferCopy region{.size = bytes.size()};
    cmd->vkCmdCopyBuffer(cmd, staging.handle, buffer.handle, 1, &region);
  });
  return buffer;
}

void memory_barrier(Commands cmd, VkPipelineStageFlags2 from_stage, VkAccessFlags2 from_access,
                    VkPipelineStageFlags2 to_stage, VkAccessFlags2 to_access) {
  const VkMemoryBarrier2 barrier{.sType = VK_STRUCTURE_TYPE_MEMORY_BARRIER_2,
                                 .srcStageMask = from_stage,
                                 .srcAccessMask = from_access,
                                 .dstStageMask = to_stage,
                                 .dstAccessMask = to_access};
  const VkDependencyInfo info{
      .sType = VK_STRUCTURE_TYPE_DEPENDENCY_INFO, .memoryBarrierCount = 1, .pMemoryBarriers = &barrier};
  cmd->vkCmdPipelineBarrier2(cmd, &info);
}

void image_barrier(Commands cmd, const Image& image, const ImageUse& from, const ImageUse& to) {
  image_barrier(cmd, image.handle, from, to, image.aspect);
}

void image_barrier(Commands cmd, VkImage image, const ImageUse& from, const ImageUse& to, VkImageAspectFlags aspect) {
  const VkImageMemoryBarrier2 barrier{
      .sType = VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER_2,
      .srcStageMask = from.stage,
      .srcAccessMask = from.access,
      .dstStageMask = to.stage,
      .dstAccessMask = to.access,
      .oldLayout = from.layout,
      .newLayout = to.layout,
      .srcQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
      .dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
      .image = image,
      .subresourceRange = {aspect, 0, VK_REMAINING_MIP_LEVELS, 0, VK_REMAINING_ARRAY_LAYERS}};
  const VkDependencyInfo info{
      .sType = VK_STRUCTURE_TYPE_DEPENDENCY_INFO, .imageMemoryBarrierCount = 1, .pImageMemoryBarriers = &barrier};
  cmd->vkCmdPipelineBarrier2(cmd, &info);
}

}  // namespace chandelier::gpu
