// SPDX-License-Identifier: Apache-2.0
#include "gpu/loader.h"

#include <dlfcn.h>
#include <volk.h>

#include <mutex>
#include <utility>

#include "gpu/device.h"

namespace chandelier::gpu {
namespace {

// volk fills a device's table through a variable of the whole process. It is lent for that under this lock, and has its
// own value again afterwards: a host may use volk too.
std::mutex volk_lock;

}  // namespace

PFN_vkGetInstanceProcAddr system_loader() {
  void* const library = dlopen("libvulkan.so.1", RTLD_NOW | RTLD_LOCAL);  // stays: the process counts it once
  void* const function = library ? dlsym(library, "vkGetInstanceProcAddr") : nullptr;
  if (!function)
    throw Error(
        "no Vulkan loader (libvulkan.so.1) on this machine; on Debian: apt install libvulkan1 mesa-vulkan-drivers");
  return reinterpret_cast<PFN_vkGetInstanceProcAddr>(function);
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
  LOAD(vkGetPhysicalDeviceImageFormatProperties);
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
  const PFN_vkGetDeviceProcAddr lent = std::exchange(vkGetDeviceProcAddr, instance.vkGetDeviceProcAddr);
  volkLoadDeviceTable(table.get(), device);
  vkGetDeviceProcAddr = lent;
  return table;
}

}  // namespace chandelier::gpu
