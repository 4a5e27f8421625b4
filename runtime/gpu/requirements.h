// SPDX-License-Identifier: Apache-2.0
// What the runtime needs of a Vulkan device: said beforehand, so that a host can make a device that fits.
#pragma once

#include <vulkan/vulkan_core.h>

#include <span>
#include <string>
#include <vector>

#include "gpu/loader.h"

namespace chandelier::gpu {

/// Needed of instance and device alike.
constexpr uint32_t needed_api_version = VK_API_VERSION_1_3;

/// Device extensions that must be enabled.
std::span<const char* const> needed_extensions();

/// The features that must be enabled, and the optional ones that are used where they are, as a chain for
/// VkDeviceCreateInfo::pNext: start at `core`. Not to be copied or moved: it points into itself.
struct Features {
  VkPhysicalDeviceVulkan13Features v13{.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_3_FEATURES};
  VkPhysicalDeviceVulkan12Features v12{.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_2_FEATURES, .pNext = &v13};
  VkPhysicalDeviceFeatures2 core{.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FEATURES_2, .pNext = &v12};

  Features() = default;
  Features(const Features&) = delete;
  Features& operator=(const Features&) = delete;
};
/// Switches on what is needed. A host may switch on more.
void add_needed(Features& features);
/// Switches on what the device has of textureCompressionBC, samplerAnisotropy and, with `bounds`, robustBufferAccess.
void add_optional(Features& features, const Features& have, bool bounds);

/// One number that a device must reach, "maxBoundDescriptorSets 4".
struct NeededLimit {
  const char* name;
  uint64_t least;
  uint64_t has;
};
std::vector<NeededLimit> needed_limits(const VkPhysicalDeviceLimits& limits);

/// A family whose queue draws, computes and times; UINT32_MAX where there is none.
uint32_t find_queue_family(const InstanceFunctions& instance, VkPhysicalDevice device);
/// Is this such a family?
bool is_fitting_family(const InstanceFunctions& instance, VkPhysicalDevice device, uint32_t family);

/// The first thing that a device lacks, "no multiDrawIndirect"; empty where it has everything.
std::string first_lack(const InstanceFunctions& instance, VkPhysicalDevice device);

}  // namespace chandelier::gpu
