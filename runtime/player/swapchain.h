// SPDX-License-Identifier: Apache-2.0
// Shows a picture in a window's surface: acquire, blit, present.
#pragma once

#include <cstdint>
#include <vector>

#include "gpu/device.h"

namespace chandelier::player {

class Swapchain {
 public:
  /// Takes the surface, which must belong to the device's instance. Throws gpu::Error.
  Swapchain(const gpu::Device& device, VkSurfaceKHR surface);
  ~Swapchain();
  Swapchain(const Swapchain&) = delete;
  Swapchain& operator=(const Swapchain&) = delete;

  /// Blits `image` (TRANSFER_SRC_OPTIMAL, its last use waited for) over the whole window and waits until that is done.
  /// `window` is the size of the window now, pixels; false where the picture is not to be seen: the window has no area,
  /// or has changed meanwhile. Throws.
  bool show(VkImage image, VkExtent2D size, VkExtent2D window);

 private:
  void choose_format();
  bool make(VkExtent2D window);
  void destroy();
  void record(VkImage from, VkExtent2D size, VkImage to);
  void submit(uint32_t index);

  const gpu::Device& device_;
  VkSurfaceKHR surface_ = VK_NULL_HANDLE;
  VkSurfaceFormatKHR format_{};
  VkExtent2D extent_{};
  VkSwapchainKHR swapchain_ = VK_NULL_HANDLE;
  std::vector<VkImage> images_;
  std::vector<VkSemaphore> drawn_;  // one per image: the presentation engine may still wait on another image's
  VkSemaphore acquired_ = VK_NULL_HANDLE;
  VkFence done_ = VK_NULL_HANDLE;
  VkCommandBuffer commands_ = VK_NULL_HANDLE;
};

}  // namespace chandelier::player
