// SPDX-License-Identifier: Apache-2.0
// A Vulkan 1.3 device with one queue: made by the runtime, or a host's own. What the validation layer said about its
// use.
#pragma once

#include <vulkan/vulkan_core.h>

#include <cstdint>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "gpu/loader.h"

namespace chandelier::gpu {

struct PipelineCache;
class Allocator;

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
  PFN_vkGetInstanceProcAddr loader = nullptr;  // null: the system's
  bool bounds = true;  // robustBufferAccess: reads and writes outside a buffer stay without effect
};

/// A host's own device, to be used by the runtime. All of it must outlive the Device made from it, the device must have
/// been made with what requirements.h asks for, and no frame may be on its way when the Device ends.
struct HostDevice {
  PFN_vkGetInstanceProcAddr get_instance_proc_addr = nullptr;
  VkInstance instance = VK_NULL_HANDLE;
  VkPhysicalDevice physical = VK_NULL_HANDLE;
  VkDevice device = VK_NULL_HANDLE;
  VkQueue queue = VK_NULL_HANDLE;  // of a family that draws, computes and times. Used by the calling thread in
  uint32_t queue_family = 0;       // Renderer's constructor, draw(), warm_up() and read_back(); never in record()
  // Optional features that the host has switched on.
  bool texture_compression_bc = false;
  bool sampler_anisotropy = false;
};

struct DeviceName {
  std::string name;
  std::string driver;  // "llvmpipe Mesa 22.3.6 (LLVM 15.0.6)"
  std::string unfit;   // why it cannot be used; empty where it can
};
/// Every Vulkan device of this machine. Throws Error where there is no Vulkan loader.
std::vector<DeviceName> list_devices();

class Device {
 public:
  explicit Device(const DeviceOptions& options);
  /// Throws Error where the host's device lacks what is needed.
  explicit Device(const HostDevice& host);
  ~Device();
  Device(const Device&) = delete;
  Device& operator=(const Device&) = delete;

  /// The device's functions: `device->vkCreateBuffer(device.handle, …)`. Include volk.h to call them.
  const VolkDeviceTable* operator->() const { return functions_.get(); }
  const VolkDeviceTable* functions() const { return functions_.get(); }
  const InstanceFunctions& instance_functions() const { return instance_functions_; }
  Allocator& allocator() const { return *allocator_; }
  PipelineCache& pipelines() const { return *pipelines_; }

  VkInstance instance = VK_NULL_HANDLE;
  VkPhysicalDevice physical = VK_NULL_HANDLE;
  VkDevice handle = VK_NULL_HANDLE;
  VkQueue queue = VK_NULL_HANDLE;
  uint32_t queue_family = 0;
  uint32_t timestamp_bits = 0;                  // valid bits of the queue's timestamps
  VkCommandPool command_pool = VK_NULL_HANDLE;  // of the runtime's own commands
  VkPhysicalDeviceLimits limits{};
  VkPhysicalDeviceMemoryProperties memory{};
  bool samples_bc = false;           // block-compressed textures
  bool samples_anisotropic = false;  // textures on slanted surfaces
  bool is_software = false;          // runs on the CPU
  std::string name;
  std::string driver;

  /// Warnings and errors of the validation layer so far.
  const std::vector<std::string>& validation_messages() const { return *validation_messages_; }
  /// The same list; it outlives the device, whose end is validated too.
  std::shared_ptr<const std::vector<std::string>> validation_log() const { return validation_messages_; }

 private:
  void make_device(const DeviceOptions& options);
  void read_properties();
  void start();
  void end();

  InstanceFunctions instance_functions_;
  DeviceFunctions functions_;
  std::unique_ptr<Allocator> allocator_;
  std::unique_ptr<PipelineCache> pipelines_;
  bool owns_ = false;  // instance and device
  VkDebugUtilsMessengerEXT messenger_ = VK_NULL_HANDLE;
  std::shared_ptr<std::vector<std::string>> validation_messages_ = std::make_shared<std::vector<std::string>>();
};

/// A command buffer that is being recorded, with the functions of its device: `cmd->vkCmdDispatch(cmd, …)`.
class Commands {
 public:
  Commands(const Device& device, VkCommandBuffer handle) : handle_(handle), functions_(device.functions()) {}
  operator VkCommandBuffer() const { return handle_; }  // NOLINT: stands for the handle in Vulkan calls
  const VolkDeviceTable* operator->() const { return functions_; }

 private:
  VkCommandBuffer handle_;
  const VolkDeviceTable* functions_;
};

}  // namespace chandelier::gpu
