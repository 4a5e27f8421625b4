// SPDX-License-Identifier: Apache-2.0
// Frames in flight: recorded frames are the drawn ones bit for bit, two devices live side by side, a host's own device
// is adopted, and a steady frame allocates nothing.
#include "gpu/frames.h"

#include <volk.h>

#include <atomic>
#include <cstdlib>
#include <new>

#include "gpu/requirements.h"
#include "gpu_test.h"

namespace {

thread_local uint64_t host_allocations = 0;  // of this thread: the driver has threads of its own

}  // namespace

// Every allocation of this program is counted. (Replaced as the standard allows: [new.delete.single].)
#pragma GCC diagnostic ignored "-Wmismatched-new-delete"  // inlined, new is malloc()
void* operator new(size_t bytes) {
  ++host_allocations;
  if (void* memory = std::malloc(bytes)) return memory;
  throw std::bad_alloc();
}
void* operator new(size_t bytes, const std::nothrow_t&) noexcept {  // or deleting what it gives would mix allocators
  ++host_allocations;
  return std::malloc(bytes);
}
void operator delete(void* memory) noexcept {
  std::free(memory);
}
void operator delete(void* memory, size_t) noexcept {
  std::free(memory);
}

namespace chandelier::test {
namespace {

constexpr uint32_t width = 96, height = 64;

Scene lamps_over_boxes() {
  Scene scene;
  const uint32_t material = scene.add_material(plain_material(glm::vec3(0.6f)));
  scene.add(box({-6, -0.2f, -6}, {6, 0, 6}), material);
  for (int i = 0; i < 4; ++i) {
    const float x = 2.0f * static_cast<float>(i) - 3.0f;
    scene.add(box({x - 0.3f, 0, -0.3f}, {x + 0.3f, 1, 0.3f}), material);
    scene.lights.push_back(point_light({x, 2.0f, 1.0f}, 30, 6));
  }
  return scene;
}

RenderSettings settings_from(float x) {
  Recipe recipe;
  recipe.face_size_px = 64;
  return settings_for(look({x, 3, 6}, {0, 0.5f, 0}, 1.0f), width, height, recipe);
}

// A host's own loop around Renderer::record(): pictures are read when their slot comes round.
class Host {
 public:
  Host(gpu::Device& device, Renderer& renderer, uint32_t slots)
      : device_(device), renderer_(renderer), ring_(device, slots) {
    for (uint32_t i = 0; i < slots; ++i) {
      images_.push_back(gpu::make_image(
          device,
          {.format = VK_FORMAT_R8G8B8A8_UNORM,
           .width = width,
           .height = height,
           .usage = VK_IMAGE_USAGE_TRANSFER_DST_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT | VK_IMAGE_USAGE_SAMPLED_BIT}));
      pixels_.push_back(
          gpu::make_buffer(device, 4 * width * height, VK_BUFFER_USAGE_TRANSFER_DST_BIT, gpu::Memory::readback));
    }
  }

  uint32_t submit(const RenderSettings& settings) {
    const uint32_t slot = ring_.next();
    const gpu::Commands cmd = ring_.begin(slot);
    renderer_.record(cmd, slot, settings,
                     {images_[slot].handle, {width, height}, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL});
    const VkBufferImageCopy copy{.imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1},
                                 .imageExtent = {width, height, 1}};
    cmd->vkCmdCopyImageToBuffer(cmd, images_[slot].handle, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, pixels_[slot].handle,
                                1, &copy);
    gpu::memory_barrier(cmd, VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT, VK_ACCESS_2_TRANSFER_WRITE_BIT,
                        VK_PIPELINE_STAGE_2_HOST_BIT, VK_ACCESS_2_HOST_READ_BIT);
    ring_.submit(slot);
    return slot;
  }
  std::vector<uint8_t> pixels(uint32_t slot) {
    ring_.wait(slot);
    const auto* first = reinterpret_cast<const uint8_t*>(pixels_[slot].mapped);
    return {first, first + 4 * width * height};
  }
  void finish() { ring_.wait_for_all(); }

 private:
  gpu::Device& device_;
  Renderer& renderer_;
  gpu::FrameRing ring_;
  std::vector<gpu::Image> images_;
  std::vector<gpu::Buffer> pixels_;
};

class FramesTest : public GpuTest {};

TEST_F(FramesTest, RecordedFramesAreTheDrawnOnesWithOneTwoAndThreeInFlight) {
  const pack::File pack = lamps_over_boxes().open();
  const World world(pack);
  Renderer drawing(device(), world);
  std::vector<std::vector<uint8_t>> drawn;
  std::vector<FrameStats> drawn_stats;
  constexpr uint32_t frames = 7;
  for (uint32_t i = 0; i < frames; ++i) {
    drawn_stats.push_back(drawing.draw(settings_from(static_cast<float>(i))));
    drawn.push_back(drawing.read_back().shown);
  }
  for (const uint32_t slots : {1u, 2u, 3u}) {
    Renderer renderer(device(), world, {.frames_in_flight = slots});
    Host host(device(), renderer, slots);
    std::vector<uint32_t> slot_of;
    const auto compare = [&](uint32_t frame) {
      EXPECT_EQ(host.pixels(slot_of[frame]), drawn[frame]) << "frame " << frame << " of " << slots << " in flight";
      const FrameStats& stats = renderer.stats(slot_of[frame]);
      EXPECT_EQ(stats.shadow_triangles, drawn_stats[frame].shadow_triangles);
      EXPECT_EQ(stats.shadow_draws, drawn_stats[frame].shadow_draws);
      EXPECT_EQ(stats.exposure_ev, drawn_stats[frame].exposure_ev);
      EXPECT_GT(stats.frame_ms, 0.0);
    };
    for (uint32_t i = 0; i < frames; ++i) {
      if (i >= slots) compare(i - slots);
      slot_of.push_back(host.submit(settings_from(static_cast<float>(i))));
    }
    for (uint32_t i = frames - slots; i < frames; ++i) compare(i);
  }
}

// A frame that needs larger images and buffers than the one that is still on its way.
TEST_F(FramesTest, WhatAFrameOnItsWayUsesIsKept) {
  const pack::File pack = lamps_over_boxes().open();
  const World world(pack);
  Renderer drawing(device(), world), renderer(device(), world);
  Host host(device(), renderer, 2);
  RenderSettings large = settings_from(1);
  large.width = 3 * width;
  large.height = 3 * height;
  large.recipe.face_size_px = 256;
  const RenderSettings small = settings_from(1);
  drawing.draw(small);
  const auto small_pixels = drawing.read_back().shown;
  for (int i = 0; i < 3; ++i) {
    const uint32_t first = host.submit(small);
    host.submit(large);
    EXPECT_EQ(host.pixels(first), small_pixels);
  }
  host.finish();
}

TEST_F(FramesTest, RaysCannotBeRecorded) {
  const pack::File pack = lamps_over_boxes().open();
  const World world(pack);
  Renderer renderer(device(), world);
  RenderSettings settings = settings_from(0);
  settings.recipe.filter = Filter::rays;
  settings.recipe.deliver = Deliver::textures;
  gpu::run_once(device(),
                [&](gpu::Commands cmd) { EXPECT_THROW(renderer.record(cmd, 0, settings), std::invalid_argument); });
}

TEST_F(FramesTest, TwoDevicesLiveSideBySide) {
  const pack::File pack = lamps_over_boxes().open();
  const World world(pack);
  Renderer renderer(device(), world);
  renderer.draw(settings_from(0));
  const auto alone = renderer.read_back().shown;
  {
    gpu::Device second({.validation = false});  // the other one has: their functions differ
    Renderer other(second, world);
    other.draw(settings_from(0));
    gpu::list_devices();  // makes and ends an instance without extensions
    renderer.draw(settings_from(0));
    EXPECT_EQ(other.read_back().shown, alone);
    EXPECT_EQ(renderer.read_back().shown, alone);
  }
  renderer.draw(settings_from(0));
  EXPECT_EQ(renderer.read_back().shown, alone);
}

// What a host may count: its loader answers with functions of its own.
std::atomic<uint64_t> device_allocations{0};
PFN_vkGetInstanceProcAddr real_loader = nullptr;
PFN_vkGetDeviceProcAddr real_device_loader = nullptr;

// One for each call that makes something: counts, then calls the device's own.
template <typename Function>
struct Counting;
template <typename... Arguments>
struct Counting<VkResult(VKAPI_PTR*)(VkDevice, Arguments...)> {
  template <size_t number>
  static VKAPI_ATTR VkResult VKAPI_CALL call(VkDevice device, Arguments... arguments);
};
constexpr const char* counted_names[]{"vkAllocateMemory",
                                      "vkCreateBuffer",
                                      "vkCreateImage",
                                      "vkCreateImageView",
                                      "vkCreateQueryPool",
                                      "vkCreateDescriptorPool",
                                      "vkAllocateDescriptorSets",
                                      "vkCreateComputePipelines",
                                      "vkCreateGraphicsPipelines",
                                      "vkCreateSampler",
                                      "vkCreateDescriptorSetLayout",
                                      "vkCreatePipelineLayout",
                                      "vkAllocateCommandBuffers"};
template <typename... Arguments>
template <size_t number>
VkResult Counting<VkResult(VKAPI_PTR*)(VkDevice, Arguments...)>::call(VkDevice device, Arguments... arguments) {
  ++device_allocations;
  const auto real =
      reinterpret_cast<VkResult(VKAPI_PTR*)(VkDevice, Arguments...)>(real_device_loader(device, counted_names[number]));
  return real(device, arguments...);
}

template <typename Function, size_t number>
PFN_vkVoidFunction counting() {
  return reinterpret_cast<PFN_vkVoidFunction>(&Counting<Function>::template call<number>);
}

VKAPI_ATTR PFN_vkVoidFunction VKAPI_CALL device_loader(VkDevice device, const char* name) {
  const PFN_vkVoidFunction functions[]{counting<PFN_vkAllocateMemory, 0>(),
                                       counting<PFN_vkCreateBuffer, 1>(),
                                       counting<PFN_vkCreateImage, 2>(),
                                       counting<PFN_vkCreateImageView, 3>(),
                                       counting<PFN_vkCreateQueryPool, 4>(),
                                       counting<PFN_vkCreateDescriptorPool, 5>(),
                                       counting<PFN_vkAllocateDescriptorSets, 6>(),
                                       counting<PFN_vkCreateComputePipelines, 7>(),
                                       counting<PFN_vkCreateGraphicsPipelines, 8>(),
                                       counting<PFN_vkCreateSampler, 9>(),
                                       counting<PFN_vkCreateDescriptorSetLayout, 10>(),
                                       counting<PFN_vkCreatePipelineLayout, 11>(),
                                       counting<PFN_vkAllocateCommandBuffers, 12>()};
  static_assert(std::size(functions) == std::size(counted_names));
  for (size_t i = 0; i < std::size(functions); ++i)
    if (std::string_view(name) == counted_names[i]) return functions[i];
  return real_device_loader(device, name);
}

VKAPI_ATTR PFN_vkVoidFunction VKAPI_CALL host_loader(VkInstance instance, const char* name) {
  if (std::string_view(name) == "vkGetDeviceProcAddr") {
    real_device_loader = reinterpret_cast<PFN_vkGetDeviceProcAddr>(real_loader(instance, name));
    return reinterpret_cast<PFN_vkVoidFunction>(&device_loader);
  }
  return real_loader(instance, name);
}

// An engine that has a Vulkan device of its own, made with what the runtime says it needs.
struct Engine {
  VkInstance instance = VK_NULL_HANDLE;
  gpu::InstanceFunctions functions;
  VkPhysicalDevice physical = VK_NULL_HANDLE;
  VkDevice device = VK_NULL_HANDLE;
  uint32_t family = 0;

  Engine() {
    real_loader = gpu::system_loader();
    const auto create = reinterpret_cast<PFN_vkCreateInstance>(real_loader(VK_NULL_HANDLE, "vkCreateInstance"));
    const VkApplicationInfo app{.sType = VK_STRUCTURE_TYPE_APPLICATION_INFO, .apiVersion = gpu::needed_api_version};
    const VkInstanceCreateInfo info{.sType = VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO, .pApplicationInfo = &app};
    gpu::check(create(&info, nullptr, &instance), "vkCreateInstance");
    functions = gpu::load_instance(real_loader, instance);
    uint32_t one = 1;
    functions.vkEnumeratePhysicalDevices(instance, &one, &physical);
    if (const std::string lack = gpu::first_lack(functions, physical); !lack.empty()) throw gpu::Error(lack);
    family = gpu::find_queue_family(functions, physical);
    gpu::Features features;
    gpu::add_needed(features);
    const float priority = 1.0f;
    const VkDeviceQueueCreateInfo queue{.sType = VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO,
                                        .queueFamilyIndex = family,
                                        .queueCount = 1,
                                        .pQueuePriorities = &priority};
    const auto extensions = gpu::needed_extensions();
    const VkDeviceCreateInfo made{.sType = VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO,
                                  .pNext = &features.core,
                                  .queueCreateInfoCount = 1,
                                  .pQueueCreateInfos = &queue,
                                  .enabledExtensionCount = static_cast<uint32_t>(extensions.size()),
                                  .ppEnabledExtensionNames = extensions.data()};
    gpu::check(functions.vkCreateDevice(physical, &made, nullptr, &device), "vkCreateDevice");
  }
  ~Engine() {
    reinterpret_cast<PFN_vkDestroyDevice>(functions.vkGetDeviceProcAddr(device, "vkDestroyDevice"))(device, nullptr);
    functions.vkDestroyInstance(instance, nullptr);
  }
  gpu::HostDevice host() const {
    return {.get_instance_proc_addr = host_loader,
            .instance = instance,
            .physical = physical,
            .device = device,
            .queue_family = family};
  }
};

// In every frame of this recipe but the first ones.
void expect_no_allocations(Host& host, Renderer& renderer, Recipe recipe, bool keep_shadow_maps = false) {
  recipe.face_size_px = 64;
  const auto settings_at = [&](float x) {
    RenderSettings settings = settings_from(x);
    settings.recipe = recipe;
    settings.keep_shadow_maps = keep_shadow_maps;
    return settings;
  };
  for (const float x : {0.0f, 1.0f, 0.0f}) host.submit(settings_at(x));
  host.finish();
  const uint64_t on_device = device_allocations;
  for (int i = 0; i < 100; ++i) host.submit(settings_at(0.01f * static_cast<float>(i)));
  host.finish();
  EXPECT_EQ(device_allocations, on_device) << "a moving camera";

  const RenderSettings still = settings_at(0);
  for (int i = 0; i < 2; ++i) {
    const uint32_t slot = host.submit(still);
    host.finish();
    renderer.stats(slot);
  }
  const uint64_t on_host = host_allocations;
  for (int i = 0; i < 100; ++i) {
    const uint32_t slot = host.submit(still);
    if (i > 0) renderer.stats(1 - slot);
  }
  host.finish();
  EXPECT_EQ(host_allocations, on_host) << "a camera that stands still";
  EXPECT_EQ(device_allocations, on_device);
}

TEST_F(FramesTest, AHostsDeviceIsAdoptedAndSteadyFramesAllocateNothing) {
  Scene scene = lamps_over_boxes();
  scene.lights.push_back(directional_light({0, -1, 0}, 0.1f));
  const pack::File pack = scene.open();
  const World world(pack);
  Renderer drawing(device(), world);
  drawing.draw(settings_from(0));
  const auto drawn = drawing.read_back().shown;

  const Engine engine;
  gpu::Device adopted(engine.host());
  Renderer renderer(adopted, world);
  Host host(adopted, renderer, 2);
  EXPECT_EQ(host.pixels(host.submit(settings_from(0))), drawn);
  EXPECT_GT(device_allocations, 0u);  // the scene itself: they are counted
  expect_no_allocations(host, renderer, Recipe());
  Recipe clusters;
  clusters.select = Select::light_clusters;
  clusters.filter = Filter::pcss;
  clusters.deliver = Deliver::textures;
  clusters.d_init_m = 2;
  expect_no_allocations(host, renderer, clusters);
  expect_no_allocations(host, renderer, Recipe(), true);
}

TEST_F(FramesTest, AHostsDeviceThatDoesNotFitIsRefused) {
  const Engine engine;
  gpu::HostDevice host = engine.host();
  host.get_instance_proc_addr = nullptr;
  EXPECT_THROW(gpu::Device{host}, gpu::Error);
  host = engine.host();
  host.queue_family = 99;
  EXPECT_THROW(gpu::Device{host}, gpu::Error);
}

// What is asked too early is there later.
TEST_F(FramesTest, StatisticsThatAreAskedTooEarlyAreReadLater) {
  const pack::File pack = lamps_over_boxes().open();
  const World world(pack);
  Renderer renderer(device(), world);
  EXPECT_THROW(renderer.read_back(), std::logic_error);
  gpu::FrameRing ring(device(), 1);
  const uint32_t slot = ring.next();
  renderer.record(ring.begin(slot), slot, settings_from(0));
  EXPECT_THROW(renderer.stats(slot), gpu::Error);  // not even submitted
  ring.submit(slot);
  ring.wait(slot);
  EXPECT_GT(renderer.stats(slot).shadow_triangles, 0u);
  EXPECT_FALSE(renderer.stats(slot).stages.empty());
}

}  // namespace
}  // namespace chandelier::test
