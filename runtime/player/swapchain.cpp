// SPDX-License-Identifier: Apache-2.0
// Shows a picture in a window's surface. One picture is in flight: drawing it takes far longer than showing it.
#include "player/swapchain.h"

#include <volk.h>

#include <algorithm>

namespace chandelier::player {
namespace {

void image_barrier(gpu::Commands commands, VkImage image, VkImageLayout from, VkImageLayout to,
                   VkAccessFlags2 src_access, VkAccessFlags2 dst_access, VkPipelineStageFlags2 dst_stage) {
  VkImageMemoryBarrier2 barrier{.sType = VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER_2};
  barrier.srcStageMask = VK_PIPELINE_STAGE_2_BLIT_BIT;
  barrier.srcAccessMask = src_access;
  barrier.dstStageMask = dst_stage;
  barrier.dstAccessMask = dst_access;
  barrier.oldLayout = from;
  barrier.newLayout = to;
  barrier.srcQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED;
  barrier.dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED;
  barrier.image = image;
  barrier.subresourceRange = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, 1};
  VkDependencyInfo dependency{.sType = VK_STRUCTURE_TYPE_DEPENDENCY_INFO};
  dependency.imageMemoryBarrierCount = 1;
  dependency.pImageMemoryBarriers = &barrier;
  commands->vkCmdPipelineBarrier2(commands, &dependency);
}

VkSemaphore make_semaphore(const gpu::Device& device) {
  const VkSemaphoreCreateInfo info{.sType = VK_STRUCTURE_TYPE_SEMAPHORE_CREATE_INFO};
  VkSemaphore semaphore = VK_NULL_HANDLE;
  gpu::check(device->vkCreateSemaphore(device.handle, &info, nullptr, &semaphore), "vkCreateSemaphore");
  return semaphore;
}

}  // namespace

Swapchain::Swapchain(const gpu::Device& device, VkSurfaceKHR surface) : device_(device), surface_(surface) {
  try {
    choose_format();
    acquired_ = make_semaphore(device_);
    const VkFenceCreateInfo fence{.sType = VK_STRUCTURE_TYPE_FENCE_CREATE_INFO};
    gpu::check(device_->vkCreateFence(device_.handle, &fence, nullptr, &done_), "vkCreateFence");
    VkCommandBufferAllocateInfo allocate{.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO};
    allocate.commandPool = device_.command_pool;
    allocate.level = VK_COMMAND_BUFFER_LEVEL_PRIMARY;
    allocate.commandBufferCount = 1;
    gpu::check(device_->vkAllocateCommandBuffers(device_.handle, &allocate, &commands_), "vkAllocateCommandBuffers");
  } catch (...) {
    destroy();
    throw;
  }
}

Swapchain::~Swapchain() {
  destroy();
}

void Swapchain::destroy() {
  device_->vkDeviceWaitIdle(device_.handle);
  for (VkSemaphore semaphore : drawn_) device_->vkDestroySemaphore(device_.handle, semaphore, nullptr);
  device_->vkDestroySwapchainKHR(device_.handle, swapchain_, nullptr);
  if (commands_ != VK_NULL_HANDLE) device_->vkFreeCommandBuffers(device_.handle, device_.command_pool, 1, &commands_);
  device_->vkDestroyFence(device_.handle, done_, nullptr);
  device_->vkDestroySemaphore(device_.handle, acquired_, nullptr);
  device_.instance_functions().vkDestroySurfaceKHR(device_.instance, surface_, nullptr);
}

void Swapchain::choose_format() {
  VkBool32 presents = VK_FALSE;
  gpu::check(device_.instance_functions().vkGetPhysicalDeviceSurfaceSupportKHR(device_.physical, device_.queue_family,
                                                                               surface_, &presents),
             "vkGetPhysicalDeviceSurfaceSupportKHR");
  if (!presents) throw gpu::Error("the device cannot show pictures in this window (" + device_.name + ")");
  uint32_t count = 0;
  gpu::check(
      device_.instance_functions().vkGetPhysicalDeviceSurfaceFormatsKHR(device_.physical, surface_, &count, nullptr),
      "surface formats");
  std::vector<VkSurfaceFormatKHR> formats(count);
  gpu::check(device_.instance_functions().vkGetPhysicalDeviceSurfaceFormatsKHR(device_.physical, surface_, &count,
                                                                               formats.data()),
             "surface formats");
  // The picture holds sRGB values already: a blit into an _SRGB format would encode them twice.
  const auto fits = [](const VkSurfaceFormatKHR& f) {
    return (f.format == VK_FORMAT_B8G8R8A8_UNORM || f.format == VK_FORMAT_R8G8B8A8_UNORM) &&
           f.colorSpace == VK_COLOR_SPACE_SRGB_NONLINEAR_KHR;
  };
  const auto found = std::find_if(formats.begin(), formats.end(), fits);
  if (found == formats.end()) throw gpu::Error("the window has no 8-bit sRGB format (" + device_.name + ")");
  format_ = *found;
}

bool Swapchain::make(VkExtent2D window) {
  VkSurfaceCapabilitiesKHR can{};
  gpu::check(device_.instance_functions().vkGetPhysicalDeviceSurfaceCapabilitiesKHR(device_.physical, surface_, &can),
             "surface capabilities");
  if ((can.supportedUsageFlags & VK_IMAGE_USAGE_TRANSFER_DST_BIT) == 0)
    throw gpu::Error("the window's images cannot be copied to (" + device_.name + ")");
  extent_ = can.currentExtent;
  if (extent_.width == UINT32_MAX)  // the surface takes the swapchain's size
    extent_ = {std::clamp(window.width, can.minImageExtent.width, can.maxImageExtent.width),
               std::clamp(window.height, can.minImageExtent.height, can.maxImageExtent.height)};
  if (extent_.width == 0 || extent_.height == 0) return false;

  VkSwapchainCreateInfoKHR info{.sType = VK_STRUCTURE_TYPE_SWAPCHAIN_CREATE_INFO_KHR};
  info.surface = surface_;
  info.minImageCount =
      can.maxImageCount == 0 ? can.minImageCount + 1 : std::min(can.minImageCount + 1, can.maxImageCount);
  info.imageFormat = format_.format;
  info.imageColorSpace = format_.colorSpace;
  info.imageExtent = extent_;
  info.imageArrayLayers = 1;
  info.imageUsage = VK_IMAGE_USAGE_TRANSFER_DST_BIT;
  info.imageSharingMode = VK_SHARING_MODE_EXCLUSIVE;
  info.preTransform = can.currentTransform;
  info.compositeAlpha = VK_COMPOSITE_ALPHA_OPAQUE_BIT_KHR;
  info.presentMode = VK_PRESENT_MODE_FIFO_KHR;  // the one mode that every device has
  info.clipped = VK_TRUE;
  info.oldSwapchain = swapchain_;
  VkSwapchainKHR fresh = VK_NULL_HANDLE;
  gpu::check(device_->vkCreateSwapchainKHR(device_.handle, &info, nullptr, &fresh), "vkCreateSwapchainKHR");
  gpu::check(device_->vkDeviceWaitIdle(device_.handle), "vkDeviceWaitIdle");
  device_->vkDestroySwapchainKHR(device_.handle, swapchain_, nullptr);
  swapchain_ = fresh;

  uint32_t count = 0;
  gpu::check(device_->vkGetSwapchainImagesKHR(device_.handle, swapchain_, &count, nullptr), "vkGetSwapchainImagesKHR");
  images_.resize(count);
  gpu::check(device_->vkGetSwapchainImagesKHR(device_.handle, swapchain_, &count, images_.data()),
             "vkGetSwapchainImagesKHR");
  for (VkSemaphore semaphore : drawn_) device_->vkDestroySemaphore(device_.handle, semaphore, nullptr);
  drawn_.clear();
  for (uint32_t i = 0; i < count; ++i) drawn_.push_back(make_semaphore(device_));
  return true;
}

bool Swapchain::show(VkImage image, VkExtent2D size, VkExtent2D window) {
  if (window.width == 0 || window.height == 0) return false;
  uint32_t index = 0;
  VkResult acquired = VK_ERROR_OUT_OF_DATE_KHR;
  if (swapchain_ != VK_NULL_HANDLE && extent_.width == window.width && extent_.height == window.height)
    acquired =
        device_->vkAcquireNextImageKHR(device_.handle, swapchain_, UINT64_MAX, acquired_, VK_NULL_HANDLE, &index);
  if (acquired == VK_ERROR_OUT_OF_DATE_KHR) {
    if (!make(window)) return false;
    acquired =
        device_->vkAcquireNextImageKHR(device_.handle, swapchain_, UINT64_MAX, acquired_, VK_NULL_HANDLE, &index);
    if (acquired == VK_ERROR_OUT_OF_DATE_KHR) return false;  // resized in between: the next frame makes it anew
  }
  if (acquired != VK_SUBOPTIMAL_KHR) gpu::check(acquired, "vkAcquireNextImageKHR");
  record(image, size, images_[index]);
  submit(index);

  VkPresentInfoKHR present{.sType = VK_STRUCTURE_TYPE_PRESENT_INFO_KHR};
  present.waitSemaphoreCount = 1;
  present.pWaitSemaphores = &drawn_[index];
  present.swapchainCount = 1;
  present.pSwapchains = &swapchain_;
  present.pImageIndices = &index;
  const VkResult presented = device_->vkQueuePresentKHR(device_.queue, &present);
  if (presented == VK_ERROR_OUT_OF_DATE_KHR || presented == VK_SUBOPTIMAL_KHR)
    extent_ = {};  // makes the next show() start anew
  else
    gpu::check(presented, "vkQueuePresentKHR");
  return presented != VK_ERROR_OUT_OF_DATE_KHR;
}

void Swapchain::record(VkImage from, VkExtent2D size, VkImage to) {
  const gpu::Commands commands(device_, commands_);
  VkCommandBufferBeginInfo begin{.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO};
  begin.flags = VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT;
  gpu::check(device_->vkBeginCommandBuffer(commands_, &begin), "vkBeginCommandBuffer");
  image_barrier(commands, to, VK_IMAGE_LAYOUT_UNDEFINED, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, VK_ACCESS_2_NONE,
                VK_ACCESS_2_TRANSFER_WRITE_BIT, VK_PIPELINE_STAGE_2_BLIT_BIT);
  VkImageBlit blit{};
  blit.srcSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1};
  blit.srcOffsets[1] = {static_cast<int32_t>(size.width), static_cast<int32_t>(size.height), 1};
  blit.dstSubresource = blit.srcSubresource;
  blit.dstOffsets[1] = {static_cast<int32_t>(extent_.width), static_cast<int32_t>(extent_.height), 1};
  device_->vkCmdBlitImage(commands_, from, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, to,
                          VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, 1, &blit, VK_FILTER_LINEAR);
  image_barrier(commands, to, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, VK_IMAGE_LAYOUT_PRESENT_SRC_KHR,
                VK_ACCESS_2_TRANSFER_WRITE_BIT, VK_ACCESS_2_NONE, VK_PIPELINE_STAGE_2_NONE);
  gpu::check(device_->vkEndCommandBuffer(commands_), "vkEndCommandBuffer");
}

void Swapchain::submit(uint32_t index) {
  VkSemaphoreSubmitInfo wait{.sType = VK_STRUCTURE_TYPE_SEMAPHORE_SUBMIT_INFO};
  wait.semaphore = acquired_;
  wait.stageMask = VK_PIPELINE_STAGE_2_BLIT_BIT;
  VkSemaphoreSubmitInfo signal{.sType = VK_STRUCTURE_TYPE_SEMAPHORE_SUBMIT_INFO};
  signal.semaphore = drawn_[index];
  signal.stageMask = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT;
  VkCommandBufferSubmitInfo commands{.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_SUBMIT_INFO};
  commands.commandBuffer = commands_;
  VkSubmitInfo2 info{.sType = VK_STRUCTURE_TYPE_SUBMIT_INFO_2};
  info.waitSemaphoreInfoCount = 1;
  info.pWaitSemaphoreInfos = &wait;
  info.commandBufferInfoCount = 1;
  info.pCommandBufferInfos = &commands;
  info.signalSemaphoreInfoCount = 1;
  info.pSignalSemaphoreInfos = &signal;
  gpu::check(device_->vkResetFences(device_.handle, 1, &done_), "vkResetFences");
  gpu::check(device_->vkQueueSubmit2(device_.queue, 1, &info, done_), "vkQueueSubmit2");
  gpu::check(device_->vkWaitForFences(device_.handle, 1, &done_, VK_TRUE, UINT64_MAX), "vkWaitForFences");
}

}  // namespace chandelier::player
