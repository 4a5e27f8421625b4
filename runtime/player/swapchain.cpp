// SPDX-License-Identifier: Apache-2.0
#include "player/swapchain.h"

#include <volk.h>

#include <algorithm>

namespace chandelier::player {
namespace {

VkSemaphore make_semaphore(const gpu::Device& device) {
  const VkSemaphoreCreateInfo info{.sType = VK_STRUCTURE_TYPE_SEMAPHORE_CREATE_INFO};
  VkSemaphore semaphore = VK_NULL_HANDLE;
  gpu::check(device->vkCreateSemaphore(device.handle, &info, nullptr, &semaphore), "vkCreateSemaphore");
  return semaphore;
}

}  // namespace

Swapchain::Swapchain(const gpu::Device& device, VkSurfaceKHR surface, uint32_t slots)
    : device_(device), surface_(surface) {
  try {
    choose_format();
    for (uint32_t i = 0; i < slots; ++i) acquired_.push_back(make_semaphore(device_));
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
  for (VkSemaphore semaphore : acquired_) device_->vkDestroySemaphore(device_.handle, semaphore, nullptr);
  device_->vkDestroySwapchainKHR(device_.handle, swapchain_, nullptr);
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
  gpu::check(device_->vkDeviceWaitIdle(device_.handle), "vkDeviceWaitIdle");
  VkSwapchainKHR fresh = VK_NULL_HANDLE;
  gpu::check(device_->vkCreateSwapchainKHR(device_.handle, &info, nullptr, &fresh), "vkCreateSwapchainKHR");
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

std::optional<WindowImage> Swapchain::acquire(uint32_t slot, VkExtent2D window) {
  if (window.width == 0 || window.height == 0) return std::nullopt;
  uint32_t index = 0;
  const auto acquire_image = [&] {
    return device_->vkAcquireNextImageKHR(device_.handle, swapchain_, UINT64_MAX, acquired_[slot], VK_NULL_HANDLE,
                                          &index);
  };
  const bool is_made = swapchain_ != VK_NULL_HANDLE && extent_.width == window.width && extent_.height == window.height;
  VkResult acquired = is_made ? acquire_image() : VK_ERROR_OUT_OF_DATE_KHR;
  if (acquired == VK_ERROR_OUT_OF_DATE_KHR) {
    if (!make(window)) return std::nullopt;
    acquired = acquire_image();
    if (acquired == VK_ERROR_OUT_OF_DATE_KHR) return std::nullopt;  // resized in between: the next frame makes it anew
  }
  if (acquired != VK_SUBOPTIMAL_KHR) gpu::check(acquired, "vkAcquireNextImageKHR");
  return WindowImage{images_[index], extent_, acquired_[slot], drawn_[index], index};
}

bool Swapchain::present(const WindowImage& image) {
  VkPresentInfoKHR present{.sType = VK_STRUCTURE_TYPE_PRESENT_INFO_KHR};
  present.waitSemaphoreCount = 1;
  present.pWaitSemaphores = &image.drawn;
  present.swapchainCount = 1;
  present.pSwapchains = &swapchain_;
  present.pImageIndices = &image.index;
  const VkResult presented = device_->vkQueuePresentKHR(device_.queue, &present);
  if (presented == VK_ERROR_OUT_OF_DATE_KHR || presented == VK_SUBOPTIMAL_KHR)
    extent_ = {};  // makes the next acquire() start anew
  else
    gpu::check(presented, "vkQueuePresentKHR");
  return presented != VK_ERROR_OUT_OF_DATE_KHR;
}

}  // namespace chandelier::player
