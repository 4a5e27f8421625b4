// SPDX-License-Identifier: Apache-2.0
// Vulkan functions: the loader's, those of one instance, and those of one device. None is kept for the whole process,
// so several instances and devices live side by side.
#pragma once

#include <vulkan/vulkan_core.h>

#include <memory>

struct VolkDeviceTable;  // volk.h: every device function as a member of its own name

namespace chandelier::gpu {

/// The system's loader, libvulkan.so.1. Throws Error where there is none.
PFN_vkGetInstanceProcAddr system_loader();

/// The functions of one instance that the runtime calls. Those of extensions are null where the instance lacks them.
struct InstanceFunctions {
  PFN_vkDestroyInstance vkDestroyInstance = nullptr;
  PFN_vkEnumeratePhysicalDevices vkEnumeratePhysicalDevices = nullptr;
  PFN_vkEnumerateDeviceExtensionProperties vkEnumerateDeviceExtensionProperties = nullptr;
  PFN_vkGetPhysicalDeviceProperties vkGetPhysicalDeviceProperties = nullptr;
  PFN_vkGetPhysicalDeviceProperties2 vkGetPhysicalDeviceProperties2 = nullptr;
  PFN_vkGetPhysicalDeviceFeatures2 vkGetPhysicalDeviceFeatures2 = nullptr;
  PFN_vkGetPhysicalDeviceFormatProperties2 vkGetPhysicalDeviceFormatProperties2 = nullptr;
  PFN_vkGetPhysicalDeviceImageFormatProperties vkGetPhysicalDeviceImageFormatProperties = nullptr;
  PFN_vkGetPhysicalDeviceMemoryProperties vkGetPhysicalDeviceMemoryProperties = nullptr;
  PFN_vkGetPhysicalDeviceQueueFamilyProperties vkGetPhysicalDeviceQueueFamilyProperties = nullptr;
  PFN_vkCreateDevice vkCreateDevice = nullptr;
  PFN_vkGetDeviceProcAddr vkGetDeviceProcAddr = nullptr;
  PFN_vkCreateDebugUtilsMessengerEXT vkCreateDebugUtilsMessengerEXT = nullptr;
  PFN_vkDestroyDebugUtilsMessengerEXT vkDestroyDebugUtilsMessengerEXT = nullptr;
  PFN_vkDestroySurfaceKHR vkDestroySurfaceKHR = nullptr;
  PFN_vkGetPhysicalDeviceSurfaceSupportKHR vkGetPhysicalDeviceSurfaceSupportKHR = nullptr;
  PFN_vkGetPhysicalDeviceSurfaceFormatsKHR vkGetPhysicalDeviceSurfaceFormatsKHR = nullptr;
  PFN_vkGetPhysicalDeviceSurfaceCapabilitiesKHR vkGetPhysicalDeviceSurfaceCapabilitiesKHR = nullptr;
};
InstanceFunctions load_instance(PFN_vkGetInstanceProcAddr loader, VkInstance instance);

struct DeleteDeviceFunctions {
  void operator()(VolkDeviceTable* table) const;
};
using DeviceFunctions = std::unique_ptr<VolkDeviceTable, DeleteDeviceFunctions>;
DeviceFunctions load_device(const InstanceFunctions& instance, VkDevice device);

}  // namespace chandelier::gpu
