// SPDX-License-Identifier: Apache-2.0
// A Vulkan 1.3 device with one queue, and what the validation layer said about its use.
#pragma once

#include <volk.h>

#include <cstdint>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

namespace chandelier::gpu {

/// A Vulkan call failed, or no device fits. what() is one line.
struct Error : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Throws Error naming `what` unless `result` is a success.
void check(VkResult result, const char* what);

struct DeviceOptions {
  std::string device;  // part of a device's name (any case) or its number in list_devices(); empty: a GPU, else a CPU
  bool validation = false;  // Khronos' layer with synchronization validation; Error where it is not installed
  std::vector<const char*> instance_extensions;  // what a window system needs
  bool swapchain = false;
};

struct DeviceName {
  std::string name;
  std::string driver;  // "llvmpipe Mesa 22.3.6 (LLVM 15.0.6)"
  std::string unfit;   // why it cannot be used; empty where it can
};
/// Every Vulkan device of this machine. Throws Error where there is no Vulkan loader.
std::vector<DeviceName> list_devices();

/// volk keeps one table of device functions for the whole program: only one Device may live at a time.
class Device {
 public:
  explicit Device(const DeviceOptions& options);
  ~Device();
  Device(const Device&) = delete;
  Device& operator=(const Device&) = delete;

  VkInstance instance = VK_NULL_HANDLE;
  VkPhysicalDevice physical = VK_NULL_HANDLE;
  VkDevice handle = VK_NULL_HANDLE;
  VkQueue queue = VK_NULL_HANDLE;
  uint32_t queue_family = 0;
  VkCommandPool command_pool = VK_NULL_HANDLE;
  VkPhysicalDeviceLimits limits{};
  VkPhysicalDeviceMemoryProperties memory{};
  bool samples_bc = false;  // block-compressed textures
  std::string name;
  std::string driver;

  /// Warnings and errors of the validation layer so far.
  const std::vector<std::string>& validation_messages() const { return *validation_messages_; }
  /// The same list; it outlives the device, whose end is validated too.
  std::shared_ptr<const std::vector<std::string>> validation_log() const { return validation_messages_; }

 private:
  VkDebugUtilsMessengerEXT messenger_ = VK_NULL_HANDLE;
  std::shared_ptr<std::vector<std::string>> validation_messages_ = std::make_shared<std::vector<std::string>>();
};

}  // namespace chandelier::gpu
