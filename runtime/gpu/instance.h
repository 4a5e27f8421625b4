// SPDX-License-Identifier: Apache-2.0
// A Vulkan instance of the runtime's own, and its choice among the machine's devices.
#pragma once

#include "gpu/device.h"

namespace chandelier::gpu {

class Instance {
 public:
  /// `messages` collects what the validation layer says, where options.validation. Throws Error.
  Instance(const DeviceOptions& options, std::vector<std::string>* messages);
  ~Instance();
  Instance(const Instance&) = delete;
  Instance& operator=(const Instance&) = delete;

  VkInstance handle() const { return handle_; }
  const InstanceFunctions& functions() const { return functions_; }
  /// The caller destroys it from now on.
  VkInstance release();

  std::vector<VkPhysicalDevice> devices() const;
  /// The best fitting device whose name has `wanted` in it, or whose number it is. Throws Error.
  VkPhysicalDevice choose(const std::string& wanted) const;
  VkDebugUtilsMessengerEXT listen(std::vector<std::string>* messages) const;

 private:
  VkInstance handle_ = VK_NULL_HANDLE;
  InstanceFunctions functions_;
};

/// "llvmpipe Mesa 22.3.6 (LLVM 15.0.6)"
std::string driver_of(const InstanceFunctions& instance, VkPhysicalDevice device);

}  // namespace chandelier::gpu
