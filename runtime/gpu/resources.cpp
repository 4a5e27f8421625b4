// SPDX-License-Identifier: Apache-2.0
// One allocation per resource: a scene has a few hundred of them, and drivers allow 4096 or more.
#include "gpu/resources.h"

#include <algorithm>
#include <cstring>

namespace chandelier::gpu {
namespace {

uint32_t find_memory(const Device& device, uint32_t allowed, VkMemoryPropertyFlags wanted, const char* what) {
  for (uint32_t i = 0; i < device.memory.memoryTypeCount; ++i)
    if ((allowed >> i & 1u) && (device.memory.memoryTypes[i].propertyFlags & wanted) == wanted) return i;
  if (wanted & VK_MEMORY_PROPERTY_HOST_CACHED_BIT)  // which a device need not have together with the others
    return find_memory(device, allowed, wanted & ~VkMemoryPropertyFlags{VK_MEMORY_PROPERTY_HOST_CACHED_BIT}, what);
  throw Error(std::string("no memory type for ") + what);
}

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

Owned<VkDeviceMemory> allocate(const Device& device, const VkMemoryRequirements& needs,
                               VkMemoryPropertyFlags properties, const char* what) {
  const VkMemoryAllocateInfo info{.sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO,
                                  .allocationSize = needs.size,
                                  .memoryTypeIndex = find_memory(device, needs.memoryTypeBits, properties, what)};
  VkDeviceMemory memory = VK_NULL_HANDLE;
  const VkResult result = vkAllocateMemory(device.handle, &info, nullptr, &memory);
  if (result < 0) throw Error("out of memory for " + std::string(what) + " (" + std::to_string(needs.size) + " bytes)");
  return {device.handle, memory, vkFreeMemory};
}

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
  check(vkCreateBuffer(device.handle, &info, nullptr, &handle), "vkCreateBuffer");
  buffer.handle = {device.handle, handle, vkDestroyBuffer};
  VkMemoryRequirements needs;
  vkGetBufferMemoryRequirements(device.handle, handle, &needs);
  buffer.memory = allocate(device, needs, properties_of(where), "a buffer");
  check(vkBindBufferMemory(device.handle, handle, buffer.memory, 0), "vkBindBufferMemory");
  if (where != Memory::device) {
    void* mapped = nullptr;
    check(vkMapMemory(device.handle, buffer.memory, 0, VK_WHOLE_SIZE, 0, &mapped), "vkMapMemory");
    buffer.mapped = static_cast<std::byte*>(mapped);
  }
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
                                 .samples = VK_SAMPLE_COUNT_1_BIT,
                                 .tiling = VK_IMAGE_TILING_OPTIMAL,
                                 .usage = info.usage};
  VkImage handle = VK_NULL_HANDLE;
  check(vkCreateImage(device.handle, &create, nullptr, &handle), "vkCreateImage");
  image.handle = {device.handle, handle, vkDestroyImage};
  VkMemoryRequirements needs;
  vkGetImageMemoryRequirements(device.handle, handle, &needs);
  image.size_bytes = needs.size;
  image.memory = allocate(device, needs, VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT, "an image");
  check(vkBindImageMemory(device.handle, handle, image.memory, 0), "vkBindImageMemory");
  image.view = make_view(device, image, info.view_type, 0, info.layers);
  return image;
}

Owned<VkImageView> make_view(const Device& device, const Image& image, VkImageViewType type, uint32_t first_layer,
                             uint32_t layer_count) {
  const VkImageViewCreateInfo info{.sType = VK_STRUCTURE_TYPE_IMAGE_VIEW_CREATE_INFO,
                                   .image = image.handle,
                                   .viewType = type,
                                   .format = image.info.format,
                                   .subresourceRange = {image.aspect, 0, image.info.levels, first_layer, layer_count}};
  VkImageView view = VK_NULL_HANDLE;
  check(vkCreateImageView(device.handle, &info, nullptr, &view), "vkCreateImageView");
  return {device.handle, view, vkDestroyImageView};
}

Owned<VkSampler> make_sampler(const Device& device, const VkSamplerCreateInfo& info) {
  VkSampler sampler = VK_NULL_HANDLE;
  check(vkCreateSampler(device.handle, &info, nullptr, &sampler), "vkCreateSampler");
  return {device.handle, sampler, vkDestroySampler};
}

void run_once(const Device& device, const std::function<void(VkCommandBuffer)>& record) {
  const VkCommandBufferAllocateInfo allocate_info{.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO,
                                                  .commandPool = device.command_pool,
                                                  .level = VK_COMMAND_BUFFER_LEVEL_PRIMARY,
                                                  .commandBufferCount = 1};
  VkCommandBuffer cmd = VK_NULL_HANDLE;
  check(vkAllocateCommandBuffers(device.handle, &allocate_info, &cmd), "vkAllocateCommandBuffers");
  struct Free {
    const Device& device;
    VkCommandBuffer cmd;
    ~Free() { vkFreeCommandBuffers(device.handle, device.command_pool, 1, &cmd); }
  } free{device, cmd};
  const VkCommandBufferBeginInfo begin{.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO,
                                       .flags = VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT};
  check(vkBeginCommandBuffer(cmd, &begin), "vkBeginCommandBuffer");
  record(cmd);
  check(vkEndCommandBuffer(cmd), "vkEndCommandBuffer");
  const VkCommandBufferSubmitInfo submitted{.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_SUBMIT_INFO,
                                            .commandBuffer = cmd};
  const VkSubmitInfo2 submit{
      .sType = VK_STRUCTURE_TYPE_SUBMIT_INFO_2, .commandBufferInfoCount = 1, .pCommandBufferInfos = &submitted};
  check(vkQueueSubmit2(device.queue, 1, &submit, VK_NULL_HANDLE), "vkQueueSubmit2");
  check(vkQueueWaitIdle(device.queue), "vkQueueWaitIdle");
}

Buffer upload_buffer(const Device& device, std::span<const std::byte> bytes, VkBufferUsageFlags usage) {
  Buffer staging = make_buffer(device, bytes.size(), VK_BUFFER_USAGE_TRANSFER_SRC_BIT, Memory::upload);
  std::copy(bytes.begin(), bytes.end(), staging.mapped);
  Buffer buffer = make_buffer(device, bytes.size(), usage | VK_BUFFER_USAGE_TRANSFER_DST_BIT, Memory::device);
  if (bytes.empty()) return buffer;
  run_once(device, [&](VkCommandBuffer cmd) {
    const VkBufferCopy region{.size = bytes.size()};
    vkCmdCopyBuffer(cmd, staging.handle, buffer.handle, 1, &region);
  });
  return buffer;
}

void memory_barrier(VkCommandBuffer cmd, VkPipelineStageFlags2 from_stage, VkAccessFlags2 from_access,
                    VkPipelineStageFlags2 to_stage, VkAccessFlags2 to_access) {
  const VkMemoryBarrier2 barrier{.sType = VK_STRUCTURE_TYPE_MEMORY_BARRIER_2,
                                 .srcStageMask = from_stage,
                                 .srcAccessMask = from_access,
                                 .dstStageMask = to_stage,
                                 .dstAccessMask = to_access};
  const VkDependencyInfo info{
      .sType = VK_STRUCTURE_TYPE_DEPENDENCY_INFO, .memoryBarrierCount = 1, .pMemoryBarriers = &barrier};
  vkCmdPipelineBarrier2(cmd, &info);
}

void image_barrier(VkCommandBuffer cmd, const Image& image, const ImageUse& from, const ImageUse& to) {
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
      .image = image.handle,
      .subresourceRange = {image.aspect, 0, VK_REMAINING_MIP_LEVELS, 0, VK_REMAINING_ARRAY_LAYERS}};
  const VkDependencyInfo info{
      .sType = VK_STRUCTURE_TYPE_DEPENDENCY_INFO, .imageMemoryBarrierCount = 1, .pImageMemoryBarriers = &barrier};
  vkCmdPipelineBarrier2(cmd, &info);
}

}  // namespace chandelier::gpu
