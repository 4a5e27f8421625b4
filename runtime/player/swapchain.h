// SPDX-License-Identifier: Apache-2.0
// A window's images: acquire one, draw, present it.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "gpu/device.h"

namespace chandelier::player {

/// An image of the window, to be drawn to.
struct WindowImage {
  VkImage image;
  VkExtent2D size;
  VkSemaphore acquired;  // to wait for before the image is written
  VkSemaphore drawn;     // to signal when it is in PRESENT_SRC_KHR
  uint32_t index;
};

class Swapchain {
 public:
  /// Takes the surface, which must belong to the device's instance. `slots`: frames in flight. Throws gpu::Error.
  Swapchain(const gpu::Device& device, VkSurfaceKHR surface, uint32_t slots);
  ~Swapchain();
  Swapchain(const Swapchain&) = delete;
  Swapchain& operator=(const Swapchain&) = delete;

  /// The next image for a frame of this slot, whose last frame has finished. `window` is the present size of the window
  /// in pixels. Empty if no picture can be shown: the window has no area, or has just changed. Throws.
  std::optional<WindowImage> acquire(uint32_t slot, VkExtent2D window);
  /// Shows it once `drawn` is signalled; false if the window has changed. Throws.
  bool present(const WindowImage& image);

 private:
  void choose_format();
  bool make(VkExtent2D window);
  void destroy();

  const gpu::Device& device_;
  VkSurfaceKHR surface_ = VK_NULL_HANDLE;
  VkSurfaceFormatKHR format_{};
  VkExtent2D extent_{};
  VkSwapchainKHR swapchain_ = VK_NULL_HANDLE;
  std::vector<VkImage> images_;
  std::vector<VkSemaphore> drawn_;     // one per image: the presentation engine may still wait on another image's
  std::vector<VkSemaphore> acquired_;  // one per slot
};

}  // namespace chandelier::player
