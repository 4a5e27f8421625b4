// SPDX-License-Identifier: Apache-2.0
#include "gpu/instance.h"

#include <algorithm>
#include <cctype>
#include <cstring>
#include <utility>

#include "gpu/requirements.h"

namespace chandelier::gpu {
namespace {

constexpr const char* validation_layer = "VK_LAYER_KHRONOS_validation";
constexpr const char* no_driver =
    "no Vulkan driver on this machine; on Debian: apt install mesa-vulkan-drivers, which has one for most GPUs and one "
    "that needs none (NVIDIA's own is nvidia-driver)";

// The loader's functions that need no instance.
template <typename Function>
Function global(PFN_vkGetInstanceProcAddr loader, const char* name) {
  return reinterpret_cast<Function>(loader(VK_NULL_HANDLE, name));
}

VKAPI_ATTR VkBool32 VKAPI_CALL on_message(VkDebugUtilsMessageSeverityFlagBitsEXT, VkDebugUtilsMessageTypeFlagsEXT,
                                          const VkDebugUtilsMessengerCallbackDataEXT* data, void* user) {
  static_cast<std::vector<std::string>*>(user)->emplace_back(data->pMessage);
  return VK_FALSE;
}

VkDebugUtilsMessengerCreateInfoEXT messenger_info(std::vector<std::string>* messages) {
  return {
      .sType = VK_STRUCTURE_TYPE_DEBUG_UTILS_MESSENGER_CREATE_INFO_EXT,
      .messageSeverity =
          VK_DEBUG_UTILS_MESSAGE_SEVERITY_WARNING_BIT_EXT | VK_DEBUG_UTILS_MESSAGE_SEVERITY_ERROR_BIT_EXT,
      .messageType = VK_DEBUG_UTILS_MESSAGE_TYPE_VALIDATION_BIT_EXT | VK_DEBUG_UTILS_MESSAGE_TYPE_PERFORMANCE_BIT_EXT,
      .pfnUserCallback = on_message,
      .pUserData = messages};
}

bool has_layer(PFN_vkGetInstanceProcAddr loader, const char* name) {
  const auto enumerate = global<PFN_vkEnumerateInstanceLayerProperties>(loader, "vkEnumerateInstanceLayerProperties");
  uint32_t count = 0;
  enumerate(&count, nullptr);
  std::vector<VkLayerProperties> layers(count);
  enumerate(&count, layers.data());
  return std::any_of(layers.begin(), layers.end(), [&](const auto& l) { return !std::strcmp(l.layerName, name); });
}

bool is_too_old(PFN_vkGetInstanceProcAddr loader) {
  const auto enumerate = global<PFN_vkEnumerateInstanceVersion>(loader, "vkEnumerateInstanceVersion");
  uint32_t version = VK_API_VERSION_1_0;
  return !enumerate || enumerate(&version) != VK_SUCCESS || version < needed_api_version;
}

VkInstance create_instance(PFN_vkGetInstanceProcAddr loader, const DeviceOptions& options,
                           std::vector<std::string>* messages) {
  if (is_too_old(loader)) throw Error("the Vulkan loader is older than 1.3");
  if (options.validation && !has_layer(loader, validation_layer))
    throw Error("the validation layer is not installed (VK_LAYER_KHRONOS_validation)");

  const VkApplicationInfo app{.sType = VK_STRUCTURE_TYPE_APPLICATION_INFO,
                              .pApplicationName = "Chandelier",
                              .pEngineName = "Chandelier",
                              .apiVersion = needed_api_version};
  std::vector<const char*> extensions = options.instance_extensions;
  auto messenger = messenger_info(messages);
  const VkValidationFeatureEnableEXT enabled = VK_VALIDATION_FEATURE_ENABLE_SYNCHRONIZATION_VALIDATION_EXT;
  const VkValidationFeaturesEXT features{.sType = VK_STRUCTURE_TYPE_VALIDATION_FEATURES_EXT,
                                         .pNext = &messenger,
                                         .enabledValidationFeatureCount = 1,
                                         .pEnabledValidationFeatures = &enabled};
  VkInstanceCreateInfo info{.sType = VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO, .pApplicationInfo = &app};
  if (options.validation) {
    extensions.push_back(VK_EXT_DEBUG_UTILS_EXTENSION_NAME);
    info.pNext = &features;
    info.enabledLayerCount = 1;
    info.ppEnabledLayerNames = &validation_layer;
  }
  info.enabledExtensionCount = static_cast<uint32_t>(extensions.size());
  info.ppEnabledExtensionNames = extensions.data();
  VkInstance instance = VK_NULL_HANDLE;
  const VkResult made = global<PFN_vkCreateInstance>(loader, "vkCreateInstance")(&info, nullptr, &instance);
  if (made == VK_ERROR_INCOMPATIBLE_DRIVER) throw Error(no_driver);  // the loader found none
  check(made, "vkCreateInstance");
  return instance;
}

std::string lower(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return text;
}

int rank(VkPhysicalDeviceType type) {
  switch (type) {
    case VK_PHYSICAL_DEVICE_TYPE_DISCRETE_GPU:
      return 3;
    case VK_PHYSICAL_DEVICE_TYPE_INTEGRATED_GPU:
      return 2;
    case VK_PHYSICAL_DEVICE_TYPE_VIRTUAL_GPU:
      return 1;
    default:
      return 0;
  }
}

bool matches(const std::string& wanted, size_t number, const std::string& name) {
  return wanted.empty() || wanted == std::to_string(number) || lower(name).find(lower(wanted)) != std::string::npos;
}

}  // namespace

Instance::Instance(const DeviceOptions& options, std::vector<std::string>* messages) {
  const PFN_vkGetInstanceProcAddr loader = options.loader ? options.loader : system_loader();
  handle_ = create_instance(loader, options, messages);
  functions_ = load_instance(loader, handle_);
}

Instance::~Instance() {
  if (handle_) functions_.vkDestroyInstance(handle_, nullptr);
}

VkInstance Instance::release() {
  return std::exchange(handle_, VkInstance{VK_NULL_HANDLE});
}

std::vector<VkPhysicalDevice> Instance::devices() const {
  uint32_t count = 0;
  check(functions_.vkEnumeratePhysicalDevices(handle_, &count, nullptr), "vkEnumeratePhysicalDevices");
  std::vector<VkPhysicalDevice> devices(count);
  check(functions_.vkEnumeratePhysicalDevices(handle_, &count, devices.data()), "vkEnumeratePhysicalDevices");
  return devices;
}

VkPhysicalDevice Instance::choose(const std::string& wanted) const {
  VkPhysicalDevice best = VK_NULL_HANDLE;
  int best_rank = -1;
  std::string reasons;
  const auto all = devices();
  for (size_t i = 0; i < all.size(); ++i) {
    VkPhysicalDeviceProperties properties;
    functions_.vkGetPhysicalDeviceProperties(all[i], &properties);
    if (!matches(wanted, i, properties.deviceName)) {
      reasons += std::string("; ") + properties.deviceName;
    } else if (const auto lack = first_lack(functions_, all[i]); !lack.empty()) {
      reasons += std::string("; ") + properties.deviceName + ": " + lack;
    } else if (rank(properties.deviceType) > best_rank) {
      best = all[i];
      best_rank = rank(properties.deviceType);
    }
  }
  if (best) return best;
  if (all.empty()) throw Error(no_driver);
  throw Error("no fitting Vulkan device" + (wanted.empty() ? std::string() : " called '" + wanted + "'") +
              " (there is" + reasons.substr(1) + ")");
}

VkDebugUtilsMessengerEXT Instance::listen(std::vector<std::string>* messages) const {
  const auto info = messenger_info(messages);
  VkDebugUtilsMessengerEXT messenger = VK_NULL_HANDLE;
  check(functions_.vkCreateDebugUtilsMessengerEXT(handle_, &info, nullptr, &messenger),
        "vkCreateDebugUtilsMessengerEXT");
  return messenger;
}

std::string driver_of(const InstanceFunctions& instance, VkPhysicalDevice device) {
  VkPhysicalDeviceDriverProperties driver{.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_DRIVER_PROPERTIES};
  VkPhysicalDeviceProperties2 properties{.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROPERTIES_2, .pNext = &driver};
  instance.vkGetPhysicalDeviceProperties2(device, &properties);
  return std::string(driver.driverName) + " " + driver.driverInfo;
}

std::vector<DeviceName> list_devices() {
  const Instance instance({}, nullptr);
  std::vector<DeviceName> names;
  for (VkPhysicalDevice device : instance.devices()) {
    VkPhysicalDeviceProperties properties;
    instance.functions().vkGetPhysicalDeviceProperties(device, &properties);
    names.push_back(
        {properties.deviceName, driver_of(instance.functions(), device), first_lack(instance.functions(), device)});
  }
  return names;
}

}  // namespace chandelier::gpu
