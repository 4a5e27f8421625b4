// SPDX-License-Identifier: Apache-2.0
// Instance, device choice, validation messages.
#include "gpu/device.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cstring>

namespace chandelier::gpu {
namespace {

constexpr const char* validation_layer = "VK_LAYER_KHRONOS_validation";
constexpr const char* no_loader =
    "no Vulkan loader (libvulkan.so.1) on this machine; on Debian: apt install libvulkan1 mesa-vulkan-drivers";
constexpr const char* no_driver =
    "no Vulkan driver on this machine; on Debian: apt install mesa-vulkan-drivers, which has one for most GPUs and one "
    "that needs none (NVIDIA's own is nvidia-driver)";

struct Instance {
  VkInstance handle = VK_NULL_HANDLE;
  Instance() = default;
  Instance(const Instance&) = delete;
  Instance& operator=(const Instance&) = delete;
  ~Instance() {
    if (handle) vkDestroyInstance(handle, nullptr);
  }
};

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

bool layer_present(const char* name) {
  uint32_t count = 0;
  vkEnumerateInstanceLayerProperties(&count, nullptr);
  std::vector<VkLayerProperties> layers(count);
  vkEnumerateInstanceLayerProperties(&count, layers.data());
  return std::any_of(layers.begin(), layers.end(), [&](const auto& l) { return !std::strcmp(l.layerName, name); });
}

VkInstance create_instance(const DeviceOptions& options, std::vector<std::string>* messages) {
  if (volkInitialize() != VK_SUCCESS) throw Error(no_loader);
  if (volkGetInstanceVersion() < VK_API_VERSION_1_3) throw Error("the Vulkan loader is older than 1.3");
  if (options.validation && !layer_present(validation_layer))
    throw Error("the validation layer is not installed (VK_LAYER_KHRONOS_validation)");

  const VkApplicationInfo app{.sType = VK_STRUCTURE_TYPE_APPLICATION_INFO,
                              .pApplicationName = "Chandelier",
                              .pEngineName = "Chandelier",
                              .apiVersion = VK_API_VERSION_1_3};
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
  const VkResult made = vkCreateInstance(&info, nullptr, &instance);
  if (made == VK_ERROR_INCOMPATIBLE_DRIVER) throw Error(no_driver);  // the loader found none
  check(made, "vkCreateInstance");
  volkLoadInstance(instance);
  return instance;
}

std::vector<VkPhysicalDevice> physical_devices(VkInstance instance) {
  uint32_t count = 0;
  check(vkEnumeratePhysicalDevices(instance, &count, nullptr), "vkEnumeratePhysicalDevices");
  std::vector<VkPhysicalDevice> devices(count);
  check(vkEnumeratePhysicalDevices(instance, &count, devices.data()), "vkEnumeratePhysicalDevices");
  return devices;
}

// Everything the runtime needs beyond Vulkan 1.3's mandatory features, asked for and enabled in one place.
struct Features {
  VkPhysicalDeviceVulkan13Features v13{.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_3_FEATURES};
  VkPhysicalDeviceVulkan12Features v12{.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_2_FEATURES, .pNext = &v13};
  VkPhysicalDeviceFeatures2 core{.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FEATURES_2, .pNext = &v12};

  struct Need {
    VkBool32* value;
    const char* name;
  };
  std::array<Need, 12> needs() {
    return {{{&core.features.fullDrawIndexUint32, "fullDrawIndexUint32"},
             {&core.features.imageCubeArray, "imageCubeArray"},
             {&core.features.multiDrawIndirect, "multiDrawIndirect"},
             {&core.features.drawIndirectFirstInstance, "drawIndirectFirstInstance"},
             {&core.features.samplerAnisotropy, "samplerAnisotropy"},
             {&v12.drawIndirectCount, "drawIndirectCount"},
             {&v12.storageBuffer8BitAccess, "storageBuffer8BitAccess"},
             {&v12.scalarBlockLayout, "scalarBlockLayout"},
             {&v12.shaderOutputLayer, "shaderOutputLayer"},
             {&v13.dynamicRendering, "dynamicRendering"},
             {&v13.maintenance4, "maintenance4"},
             {&v13.synchronization2, "synchronization2"}}};
  }
};

bool has_extension(VkPhysicalDevice device, const char* name) {
  uint32_t count = 0;
  vkEnumerateDeviceExtensionProperties(device, nullptr, &count, nullptr);
  std::vector<VkExtensionProperties> all(count);
  vkEnumerateDeviceExtensionProperties(device, nullptr, &count, all.data());
  return std::any_of(all.begin(), all.end(), [&](const auto& e) { return !std::strcmp(e.extensionName, name); });
}

// A family that draws, computes and times.
uint32_t find_queue_family(VkPhysicalDevice device) {
  uint32_t count = 0;
  vkGetPhysicalDeviceQueueFamilyProperties(device, &count, nullptr);
  std::vector<VkQueueFamilyProperties> families(count);
  vkGetPhysicalDeviceQueueFamilyProperties(device, &count, families.data());
  constexpr VkQueueFlags needed = VK_QUEUE_GRAPHICS_BIT | VK_QUEUE_COMPUTE_BIT;
  for (uint32_t i = 0; i < count; ++i)
    if ((families[i].queueFlags & needed) == needed && families[i].timestampValidBits) return i;
  return UINT32_MAX;
}

// What pixels tell their neighbours in shadows/filter/block.glsl.
bool subgroups_share(VkPhysicalDevice device) {
  VkPhysicalDeviceSubgroupProperties subgroup{.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_SUBGROUP_PROPERTIES};
  VkPhysicalDeviceProperties2 properties{.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROPERTIES_2, .pNext = &subgroup};
  vkGetPhysicalDeviceProperties2(device, &properties);
  constexpr VkSubgroupFeatureFlags needed =
      VK_SUBGROUP_FEATURE_VOTE_BIT | VK_SUBGROUP_FEATURE_BALLOT_BIT | VK_SUBGROUP_FEATURE_SHUFFLE_BIT;
  return (subgroup.supportedStages & VK_SHADER_STAGE_COMPUTE_BIT) && (subgroup.supportedOperations & needed) == needed;
}

std::string missing(VkPhysicalDevice device) {
  VkPhysicalDeviceProperties properties;
  vkGetPhysicalDeviceProperties(device, &properties);
  if (properties.apiVersion < VK_API_VERSION_1_3) return "Vulkan older than 1.3";
  Features have;
  vkGetPhysicalDeviceFeatures2(device, &have.core);
  for (const auto& need : have.needs())
    if (!*need.value) return std::string("no ") + need.name;
  if (!has_extension(device, VK_KHR_PUSH_DESCRIPTOR_EXTENSION_NAME)) return "no VK_KHR_push_descriptor";
  if (!subgroups_share(device)) return "no vote, ballot and shuffle in compute subgroups";
  if (find_queue_family(device) == UINT32_MAX) return "no queue that draws, computes and times";
  return {};
}

std::string driver_of(VkPhysicalDevice device) {
  VkPhysicalDeviceDriverProperties driver{.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_DRIVER_PROPERTIES};
  VkPhysicalDeviceProperties2 properties{.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROPERTIES_2, .pNext = &driver};
  vkGetPhysicalDeviceProperties2(device, &properties);
  return std::string(driver.driverName) + " " + driver.driverInfo;
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

VkPhysicalDevice choose(VkInstance instance, const std::string& wanted) {
  VkPhysicalDevice best = VK_NULL_HANDLE;
  int best_rank = -1;
  std::string reasons;
  const auto devices = physical_devices(instance);
  for (size_t i = 0; i < devices.size(); ++i) {
    VkPhysicalDeviceProperties properties;
    vkGetPhysicalDeviceProperties(devices[i], &properties);
    if (!matches(wanted, i, properties.deviceName)) {
      reasons += std::string("; ") + properties.deviceName;
    } else if (const auto lack = missing(devices[i]); !lack.empty()) {
      reasons += std::string("; ") + properties.deviceName + ": " + lack;
    } else if (rank(properties.deviceType) > best_rank) {
      best = devices[i];
      best_rank = rank(properties.deviceType);
    }
  }
  if (best) return best;
  if (devices.empty()) throw Error(no_driver);
  throw Error("no fitting Vulkan device" + (wanted.empty() ? std::string() : " called '" + wanted + "'") +
              " (there is" + reasons.substr(1) + ")");
}

}  // namespace

void check(VkResult result, const char* what) {
  if (result < 0) throw Error(std::string(what) + " failed (VkResult " + std::to_string(result) + ")");
}

std::vector<DeviceName> list_devices() {
  Instance instance;
  instance.handle = create_instance({}, nullptr);
  std::vector<DeviceName> names;
  for (VkPhysicalDevice device : physical_devices(instance.handle)) {
    VkPhysicalDeviceProperties properties;
    vkGetPhysicalDeviceProperties(device, &properties);
    names.push_back({properties.deviceName, driver_of(device), missing(device)});
  }
  return names;
}

Device::Device(const DeviceOptions& options) {
  Instance owned;
  owned.handle = create_instance(options, validation_messages_.get());
  instance = owned.handle;
  physical = choose(instance, options.device);
  queue_family = find_queue_family(physical);

  VkPhysicalDeviceProperties properties;
  vkGetPhysicalDeviceProperties(physical, &properties);
  vkGetPhysicalDeviceMemoryProperties(physical, &memory);
  limits = properties.limits;
  name = properties.deviceName;
  driver = driver_of(physical);

  Features features;
  for (const auto& need : features.needs()) *need.value = VK_TRUE;
  VkPhysicalDeviceFeatures have;
  vkGetPhysicalDeviceFeatures(physical, &have);
  features.core.features.textureCompressionBC = have.textureCompressionBC;
  samples_bc = have.textureCompressionBC;
  std::vector<const char*> extensions{VK_KHR_PUSH_DESCRIPTOR_EXTENSION_NAME};
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
  check(vkCreateDevice(physical, &info, nullptr, &handle), "vkCreateDevice");
  volkLoadDevice(handle);
  vkGetDeviceQueue(handle, queue_family, 0, &queue);
  const VkCommandPoolCreateInfo pool{.sType = VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO,
                                     .flags = VK_COMMAND_POOL_CREATE_RESET_COMMAND_BUFFER_BIT,
                                     .queueFamilyIndex = queue_family};
  check(vkCreateCommandPool(handle, &pool, nullptr, &command_pool), "vkCreateCommandPool");
  if (options.validation) {
    const auto messenger = messenger_info(validation_messages_.get());
    check(vkCreateDebugUtilsMessengerEXT(instance, &messenger, nullptr, &messenger_), "vkCreateDebugUtilsMessengerEXT");
  }
  owned.handle = VK_NULL_HANDLE;
}

Device::~Device() {
  vkDeviceWaitIdle(handle);
  vkDestroyCommandPool(handle, command_pool, nullptr);
  vkDestroyDevice(handle, nullptr);
  if (messenger_) vkDestroyDebugUtilsMessengerEXT(instance, messenger_, nullptr);
  vkDestroyInstance(instance, nullptr);
}

}  // namespace chandelier::gpu
