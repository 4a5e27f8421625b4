// SPDX-License-Identifier: Apache-2.0
#include "gpu/loader.h"

#include <volk.h>

#include <mutex>

#include "gpu/device.h"

namespace chandelier::gpu {
namespace {

// volk finds the loader and a device's functions through two variables of the whole process: they are set and used
// under this lock, and nothing else reads them.
std::mutex volk_lock;

}  // namespace

PFN_vkGetInstanceProcAddr system_loader() {
  const std::lock_guard lock(volk_lock);
  if (volkInitialize() != VK_SUCCESS)
    throw Error(
        "no Vulkan loader (libvulkan.so.1) on this machine; on Debian: apt install libvulkan1 mesa-vulkan-drivers");
  return vkGetInstanceProcAddr;
}

InstanceFunctions load_instance(PFN_vkGetInstanceProcAddr loader, VkInstance instance) {
  InstanceFunctions f;
  const auto load = [&](auto& function, const char* name) {
    function = reinterpret_cast<std::decay_t<decltype(function)>>(loader(instance, name));
  };
#define LOAD(name) load(f.name, #name)
  LOAD(vkDestroyInstance);
  LOAD(vkEnumeratePhysicalDevices);
  LOAD(vkEnumerateDeviceExtensionProperties);
  LOAD(vkGetPhysicalDeviceProperties);
  LOAD(vkGetPhysicalDeviceProperties2);
  LOAD(vkGetPhysicalDeviceFeatures2);
  LOAD(vkGetPhysicalDeviceFormatProperties2);
  LOAD(vkGetPhysicalDeviceMemoryProperties);
  LOAD(vkGetPhysicalDeviceQueueFamilyProperties);
  LOAD(vkCreateDevice);
  LOAD(vkGetDeviceProcAddr);
  LOAD(vkCreateDebugUtilsMessengerEXT);
  LOAD(vkDestroyDebugUtilsMessengerEXT);
  LOAD(vkDestroySurfaceKHR);
  LOAD(vkGetPhysicalDeviceSurfaceSupportKHR);
  LOAD(vkGetPhysicalDeviceSurfaceFormatsKHR);
  LOAD(vkGetPhysicalDeviceSurfaceCapabilitiesKHR);
#undef LOAD
  return f;
}

void DeleteDeviceFunctions::operator()(VolkDeviceTable* table) const {
  delete table;
}

DeviceFunctions load_device(const InstanceFunctions& instance, VkDevice device) {
  DeviceFunctions table(new VolkDeviceTable{});
  const std::lock_guard lock(volk_lock);
  vkGetDeviceProcAddr = instance.vkGetDeviceProcAddr;
  volkLoadDeviceTable(table.get(), device);
  return table;
}

}  // namespace chandelier::gpu
