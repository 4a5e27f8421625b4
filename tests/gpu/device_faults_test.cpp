// SPDX-License-Identifier: Apache-2.0
// Devices that lack something or fail: a loader stands between the runtime and Vulkan and changes single answers.
#include <volk.h>

#include <map>
#include <string>

#include "gpu/requirements.h"
#include "gpu_test.h"

namespace chandelier::test {
namespace {

PFN_vkGetInstanceProcAddr real_loader = nullptr;
PFN_vkGetDeviceProcAddr real_device_loader = nullptr;
VkInstance current_instance = VK_NULL_HANDLE;
VkDevice current_device = VK_NULL_HANDLE;
std::map<std::string, PFN_vkVoidFunction, std::less<>> replaced;
std::map<std::string, int> calls;

template <typename Function>
Function of_instance(const char* name) {
  return reinterpret_cast<Function>(real_loader(current_instance, name));
}
template <typename Function>
Function of_device(const char* name) {
  return reinterpret_cast<Function>(real_device_loader(current_device, name));
}

VKAPI_ATTR PFN_vkVoidFunction VKAPI_CALL device_loader(VkDevice device, const char* name) {
  current_device = device;
  const auto found = replaced.find(name);
  return found != replaced.end() ? found->second : real_device_loader(device, name);
}

VKAPI_ATTR PFN_vkVoidFunction VKAPI_CALL loader(VkInstance instance, const char* name) {
  if (instance) current_instance = instance;
  const auto found = replaced.find(name);
  if (found != replaced.end()) return found->second;
  if (std::string_view(name) != "vkGetDeviceProcAddr") return real_loader(instance, name);
  real_device_loader = reinterpret_cast<PFN_vkGetDeviceProcAddr>(real_loader(instance, name));
  return reinterpret_cast<PFN_vkVoidFunction>(&device_loader);
}

template <typename Function>
void replace(const char* name, Function function) {
  replaced[name] = reinterpret_cast<PFN_vkVoidFunction>(function);
}

VKAPI_ATTR VkResult VKAPI_CALL no_command_pool(VkDevice, const VkCommandPoolCreateInfo*, const VkAllocationCallbacks*,
                                               VkCommandPool*) {
  return VK_ERROR_OUT_OF_HOST_MEMORY;
}
VKAPI_ATTR void VKAPI_CALL destroy_device(VkDevice device, const VkAllocationCallbacks* with) {
  ++calls["vkDestroyDevice"];
  of_device<PFN_vkDestroyDevice>("vkDestroyDevice")(device, with);
}
VKAPI_ATTR void VKAPI_CALL destroy_instance(VkInstance instance, const VkAllocationCallbacks* with) {
  ++calls["vkDestroyInstance"];
  of_instance<PFN_vkDestroyInstance>("vkDestroyInstance")(instance, with);
}
VKAPI_ATTR void VKAPI_CALL one_draw(VkPhysicalDevice device, VkPhysicalDeviceProperties* properties) {
  of_instance<PFN_vkGetPhysicalDeviceProperties>("vkGetPhysicalDeviceProperties")(device, properties);
  properties->limits.maxDrawIndirectCount = 1;
}
VKAPI_ATTR void VKAPI_CALL small_groups(VkPhysicalDevice device, VkPhysicalDeviceProperties* properties) {
  of_instance<PFN_vkGetPhysicalDeviceProperties>("vkGetPhysicalDeviceProperties")(device, properties);
  properties->limits.maxComputeWorkGroupInvocations = 128;
}
VKAPI_ATTR void VKAPI_CALL no_comparing(VkPhysicalDevice device, VkFormat format, VkFormatProperties2* properties) {
  of_instance<PFN_vkGetPhysicalDeviceFormatProperties2>("vkGetPhysicalDeviceFormatProperties2")(device, format,
                                                                                                properties);
  static_cast<VkFormatProperties3*>(properties->pNext)->optimalTilingFeatures &=
      ~VK_FORMAT_FEATURE_2_SAMPLED_IMAGE_DEPTH_COMPARISON_BIT;
}
VKAPI_ATTR VkResult VKAPI_CALL submit(VkQueue queue, uint32_t count, const VkSubmitInfo2* submits, VkFence fence) {
  ++calls["vkQueueSubmit2"];
  return of_device<PFN_vkQueueSubmit2>("vkQueueSubmit2")(queue, count, submits, fence);
}

class DeviceFaultsTest : public testing::Test {
 protected:
  void SetUp() override {
    real_loader = gpu::system_loader();
    replaced.clear();
    calls.clear();
    replace("vkDestroyDevice", destroy_device);
    replace("vkDestroyInstance", destroy_instance);
  }
  static std::string refusal() {
    try {
      gpu::Device device({.loader = loader});
      return "none";
    } catch (const gpu::Error& error) {
      return error.what();
    }
  }
};

TEST_F(DeviceFaultsTest, WhatWasMadeBeforeAFailureIsDestroyed) {
  replace("vkCreateCommandPool", no_command_pool);
  EXPECT_NE(refusal().find("vkCreateCommandPool"), std::string::npos);
  EXPECT_EQ(calls["vkDestroyDevice"], 1);
  EXPECT_EQ(calls["vkDestroyInstance"], 1);
}

TEST_F(DeviceFaultsTest, LimitsAreChecked) {
  EXPECT_EQ(refusal(), "none");
  replace("vkGetPhysicalDeviceProperties", one_draw);
  EXPECT_NE(refusal().find("maxDrawIndirectCount 1 ("), std::string::npos) << refusal();
  replace("vkGetPhysicalDeviceProperties", small_groups);
  EXPECT_NE(refusal().find("maxComputeWorkGroupInvocations 128 (256 are needed)"), std::string::npos) << refusal();
  replaced.erase("vkGetPhysicalDeviceProperties");
  replace("vkGetPhysicalDeviceFormatProperties2", no_comparing);
  EXPECT_NE(refusal().find("no comparing sampler for D32_SFLOAT"), std::string::npos) << refusal();
}

// One for the scene, however many images it has, and one for the draw lists.
TEST_F(DeviceFaultsTest, ASceneIsUploadedInTwoSubmits) {
  replace("vkQueueSubmit2", submit);
  Scene scene;
  for (uint32_t i = 0; i < 20; ++i) {
    pack::Material material = plain_material(glm::vec3(1.0f));
    material.base_color_texture = scene.add_texture(1, 1, {0xFF000000u + i});
    scene.add(quad({0, 0, 0}, {1, 0, 0}, {0, 1, 0}), scene.add_material(material));
  }
  const pack::File pack = scene.open();
  const World world(pack);
  gpu::Device device({.loader = loader});
  uint64_t done = 0, all = 0;
  const Renderer renderer(device, world, {.upload_progress = [&](uint64_t done_bytes, uint64_t all_bytes) {
                            done = done_bytes;
                            all = all_bytes;
                          }});
  EXPECT_EQ(calls["vkQueueSubmit2"], 2);
  EXPECT_GT(all, 0u);
  EXPECT_GE(done, all);
}

}  // namespace
}  // namespace chandelier::test
