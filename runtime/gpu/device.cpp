// SPDX-License-Identifier: Apache-2.0
#include "gpu/device.h"

#include <volk.h>

#include "gpu/allocator.h"
#include "gpu/instance.h"
#include "gpu/pipeline_cache.h"
#include "gpu/requirements.h"

namespace chandelier::gpu {

void check(VkResult result, const char* what) {
  if (result < 0) throw Error(std::string(what) + " failed (VkResult " + std::to_string(result) + ")");
}

namespace {

InstanceFunctions load_host_instance(const HostDevice& host) {
  if (!host.get_instance_proc_addr || !host.instance || !host.physical || !host.device)
    throw Error("the host's Vulkan device does not fit: a handle or get_instance_proc_addr is missing");
  return load_instance(host.get_instance_proc_addr, host.instance);
}

}  // namespace

Device::Device(const DeviceOptions& options) : owns_(true) {
  Instance made(options, validation_messages_.get());
  instance_functions_ = made.functions();
  physical = made.choose(options.device);
  if (options.validation) messenger_ = made.listen(validation_messages_.get());
  instance = made.release();
  try {
    make_device(options);
    start();
  } catch (...) {
    end();
    throw;
  }
}

Device::Device(const HostDevice& host)
    : instance(host.instance),
      physical(host.physical),
      handle(host.device),
      queue(host.queue),
      queue_family(host.queue_family),
      samples_bc(host.texture_compression_bc),
      samples_anisotropic(host.sampler_anisotropy),
      instance_functions_(load_host_instance(host)) {
  if (!instance_functions_.vkGetPhysicalDeviceFormatProperties2)
    throw Error("the host's Vulkan instance does not fit: it was made for an older version than 1.3");
  if (const std::string lack = first_lack(instance_functions_, physical); !lack.empty())
    throw Error("the host's Vulkan device does not fit: " + lack);
  if (!is_fitting_family(instance_functions_, physical, queue_family))
    throw Error("the host's Vulkan queue does not fit: family " + std::to_string(queue_family) +
                " does not draw, compute and time");
  try {
    start();
  } catch (...) {
    end();
    throw;
  }
}

Device::~Device() {
  end();
}

void Device::make_device(const DeviceOptions& options) {
  queue_family = find_queue_family(instance_functions_, physical);
  Features have;
  instance_functions_.vkGetPhysicalDeviceFeatures2(physical, &have.core);
  Features features;
  add_needed(features);
  add_optional(features, have, options.bounds);
  samples_bc = features.core.features.textureCompressionBC;
  samples_anisotropic = features.core.features.samplerAnisotropy;

  std::vector<const char*> extensions(needed_extensions().begin(), needed_extensions().end());
  if (options.swapchain) extensions.push_back(VK_KHR_SWAPCHAIN_EXTENSION_NAME);
  const float priority = 1.0f;
  const VkDeviceQueueCreateInfo queue_info{.sType = VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO,
                                           .queueFamilyIndex = queue_family,
                                           .queueCount = 1,
                                           .pQueuePriorities = &priority};
  const VkDeviceCreateInfo info{.sType = VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO,
                                .pNext = &features.core,
                                .queueCreateInfoCount = 1,
                                .pQueueCreateInfos = &queue_info,
                                .enabledExtensionCount = static_cast<uint32_t>(extensions.size()),
                                .ppEnabledExtensionNames = extensions.data()};
  check(instance_functions_.vkCreateDevice(physical, &info, nullptr, &handle), "vkCreateDevice");
}

void Device::read_properties() {
  VkPhysicalDeviceProperties properties;
  instance_functions_.vkGetPhysicalDeviceProperties(physical, &properties);
  instance_functions_.vkGetPhysicalDeviceMemoryProperties(physical, &memory);
  limits = properties.limits;
  is_software = properties.deviceType == VK_PHYSICAL_DEVICE_TYPE_CPU;
  name = properties.deviceName;
  driver = driver_of(instance_functions_, physical);

  uint32_t count = 0;
  instance_functions_.vkGetPhysicalDeviceQueueFamilyProperties(physical, &count, nullptr);
  std::vector<VkQueueFamilyProperties> families(count);
  instance_functions_.vkGetPhysicalDeviceQueueFamilyProperties(physical, &count, families.data());
  if (queue_family >= count) throw Error("the device has no queue family " + std::to_string(queue_family));
  timestamp_bits = families[queue_family].timestampValidBits;
}

// What an own device and a host's have in common.
void Device::start() {
  functions_ = load_device(instance_functions_, handle);
  if (!functions_->vkCmdPushDescriptorSetKHR || !functions_->vkCmdPipelineBarrier2)
    throw Error("the Vulkan device was made without VK_KHR_push_descriptor, or for a version before 1.3");
  read_properties();
  if (!queue) functions_->vkGetDeviceQueue(handle, queue_family, 0, &queue);
  const VkCommandPoolCreateInfo pool{.sType = VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO,
                                     .flags = VK_COMMAND_POOL_CREATE_RESET_COMMAND_BUFFER_BIT,
                                     .queueFamilyIndex = queue_family};
  check(functions_->vkCreateCommandPool(handle, &pool, nullptr, &command_pool), "vkCreateCommandPool");
  allocator_ = std::make_unique<Allocator>(*this);
  pipelines_ = std::make_unique<PipelineCache>();
}

void Device::end() {
  if (functions_) {
    if (owns_) functions_->vkDeviceWaitIdle(handle);  // a host waits for its own queues
    pipelines_.reset();
    allocator_.reset();
    if (command_pool) functions_->vkDestroyCommandPool(handle, command_pool, nullptr);
    if (owns_) functions_->vkDestroyDevice(handle, nullptr);
  }
  if (!owns_) return;
  if (messenger_) instance_functions_.vkDestroyDebugUtilsMessengerEXT(instance, messenger_, nullptr);
  if (instance) instance_functions_.vkDestroyInstance(instance, nullptr);
}

}  // namespace chandelier::gpu
