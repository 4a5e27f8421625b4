// SPDX-License-Identifier: Apache-2.0
#include "gpu/requirements.h"

#include <algorithm>
#include <array>
#include <cstring>

namespace chandelier::gpu {
namespace {

constexpr std::array extensions{VK_KHR_PUSH_DESCRIPTOR_EXTENSION_NAME};

struct Need {
  VkBool32* value;
  const char* name;
};

std::array<Need, 12> needs(Features& f) {
  return {{{&f.core.features.fullDrawIndexUint32, "fullDrawIndexUint32"},
           {&f.core.features.imageCubeArray, "imageCubeArray"},
           {&f.core.features.multiDrawIndirect, "multiDrawIndirect"},
           {&f.core.features.drawIndirectFirstInstance, "drawIndirectFirstInstance"},
           {&f.core.features.shaderClipDistance, "shaderClipDistance"},
           {&f.v12.drawIndirectCount, "drawIndirectCount"},
           {&f.v12.storageBuffer8BitAccess, "storageBuffer8BitAccess"},
           {&f.v12.scalarBlockLayout, "scalarBlockLayout"},
           {&f.v12.shaderOutputLayer, "shaderOutputLayer"},
           {&f.v13.dynamicRendering, "dynamicRendering"},
           {&f.v13.maintenance4, "maintenance4"},
           {&f.v13.synchronization2, "synchronization2"}}};
}

bool has_extension(const InstanceFunctions& instance, VkPhysicalDevice device, const char* name) {
  uint32_t count = 0;
  instance.vkEnumerateDeviceExtensionProperties(device, nullptr, &count, nullptr);
  std::vector<VkExtensionProperties> all(count);
  instance.vkEnumerateDeviceExtensionProperties(device, nullptr, &count, all.data());
  return std::any_of(all.begin(), all.end(), [&](const auto& e) { return !std::strcmp(e.extensionName, name); });
}

// The neighbouring pixels of shadows/filter/block.glsl share what they read.
bool subgroups_share(const InstanceFunctions& instance, VkPhysicalDevice device) {
  VkPhysicalDeviceSubgroupProperties subgroup{.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_SUBGROUP_PROPERTIES};
  VkPhysicalDeviceProperties2 properties{.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROPERTIES_2, .pNext = &subgroup};
  instance.vkGetPhysicalDeviceProperties2(device, &properties);
  constexpr VkSubgroupFeatureFlags needed =
      VK_SUBGROUP_FEATURE_VOTE_BIT | VK_SUBGROUP_FEATURE_BALLOT_BIT | VK_SUBGROUP_FEATURE_SHUFFLE_BIT;
  return (subgroup.supportedStages & VK_SHADER_STAGE_COMPUTE_BIT) && (subgroup.supportedOperations & needed) == needed;
}

// Filters compare depths in the sampler, linearly too: a comparing sampler may do that wherever it may compare at all.
bool compares_depths(const InstanceFunctions& instance, VkPhysicalDevice device) {
  VkFormatProperties3 depth{.sType = VK_STRUCTURE_TYPE_FORMAT_PROPERTIES_3};
  VkFormatProperties2 properties{.sType = VK_STRUCTURE_TYPE_FORMAT_PROPERTIES_2, .pNext = &depth};
  instance.vkGetPhysicalDeviceFormatProperties2(device, VK_FORMAT_D32_SFLOAT, &properties);
  constexpr VkFormatFeatureFlags2 needed = VK_FORMAT_FEATURE_2_DEPTH_STENCIL_ATTACHMENT_BIT |
                                           VK_FORMAT_FEATURE_2_SAMPLED_IMAGE_BIT |
                                           VK_FORMAT_FEATURE_2_SAMPLED_IMAGE_DEPTH_COMPARISON_BIT;
  return (depth.optimalTilingFeatures & needed) == needed;
}

}  // namespace

std::span<const char* const> needed_extensions() {
  return extensions;
}

void add_needed(Features& features) {
  for (const Need& need : needs(features)) *need.value = VK_TRUE;
}

void add_optional(Features& features, const Features& have, bool bounds) {
  VkPhysicalDeviceFeatures& on = features.core.features;
  on.textureCompressionBC = have.core.features.textureCompressionBC;
  on.samplerAnisotropy = have.core.features.samplerAnisotropy;
  on.robustBufferAccess = bounds && have.core.features.robustBufferAccess;
}

std::vector<NeededLimit> needed_limits(const VkPhysicalDeviceLimits& limits) {
  return {{"maxComputeWorkGroupInvocations", 256, limits.maxComputeWorkGroupInvocations},
          {"maxComputeWorkGroupSize[0]", 256, limits.maxComputeWorkGroupSize[0]},
          {"maxComputeWorkGroupSize[1]", 16, limits.maxComputeWorkGroupSize[1]},
          {"maxDrawIndirectCount", 65535, limits.maxDrawIndirectCount},
          {"maxBoundDescriptorSets", 2, limits.maxBoundDescriptorSets},
          {"maxPerStageDescriptorStorageBuffers", 14, limits.maxPerStageDescriptorStorageBuffers},
          {"maxClipDistances", 4, limits.maxClipDistances},
          {"maxPushConstantsSize", 128, limits.maxPushConstantsSize},
          {"maxFramebufferLayers", 6, limits.maxFramebufferLayers},
          {"maxImageArrayLayers", 6, limits.maxImageArrayLayers}};
}

bool is_fitting_family(const InstanceFunctions& instance, VkPhysicalDevice device, uint32_t family) {
  uint32_t count = 0;
  instance.vkGetPhysicalDeviceQueueFamilyProperties(device, &count, nullptr);
  std::vector<VkQueueFamilyProperties> families(count);
  instance.vkGetPhysicalDeviceQueueFamilyProperties(device, &count, families.data());
  constexpr VkQueueFlags needed = VK_QUEUE_GRAPHICS_BIT | VK_QUEUE_COMPUTE_BIT;
  return family < count && (families[family].queueFlags & needed) == needed && families[family].timestampValidBits;
}

uint32_t find_queue_family(const InstanceFunctions& instance, VkPhysicalDevice device) {
  uint32_t count = 0;
  instance.vkGetPhysicalDeviceQueueFamilyProperties(device, &count, nullptr);
  for (uint32_t i = 0; i < count; ++i)
    if (is_fitting_family(instance, device, i)) return i;
  return UINT32_MAX;
}

std::string first_lack(const InstanceFunctions& instance, VkPhysicalDevice device) {
  VkPhysicalDeviceProperties properties;
  instance.vkGetPhysicalDeviceProperties(device, &properties);
  if (properties.apiVersion < needed_api_version) return "Vulkan older than 1.3";
  Features have;
  instance.vkGetPhysicalDeviceFeatures2(device, &have.core);
  for (const Need& need : needs(have))
    if (!*need.value) return std::string("no ") + need.name;
  for (const char* extension : extensions)
    if (!has_extension(instance, device, extension)) return std::string("no ") + extension;
  for (const NeededLimit& limit : needed_limits(properties.limits))
    if (limit.has < limit.least)
      return std::string(limit.name) + " " + std::to_string(limit.has) + " (" + std::to_string(limit.least) +
             " are needed)";
  if (!subgroups_share(instance, device)) return "no vote, ballot and shuffle in compute subgroups";
  if (!compares_depths(instance, device)) return "no comparing sampler for D32_SFLOAT";
  if (find_queue_family(instance, device) == UINT32_MAX) return "no queue that draws, computes and times";
  return {};
}

}  // namespace chandelier::gpu
