// SPDX-License-Identifier: Apache-2.0
// A frame: its stages in order, barriers in sight.
#include "frame/renderer.h"

#include <algorithm>
#include <chrono>
#include <cstring>

#include "frame/rounds.h"
#include "frame/targets.h"
#include "gpu/timers.h"
#include "lights/light_list.h"
#include "scene/gpu_scene.h"
#include "shading/g_buffer.h"
#include "shading/shade.h"
#include "shading/tone_map.h"
#include "shadows/project/shadow_views.h"
#include "shadows/raster/caster_pass.h"

namespace chandelier {
namespace {

using Clock = std::chrono::steady_clock;
double ms_since(Clock::time_point start) {
  return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

constexpr uint64_t most_draws = uint64_t{1} << 20;  // of a round, unless one light alone needs more: 32 MiB

// A list that the CPU writes and shaders read, every frame anew.
struct Streamed {
  gpu::Buffer staging;
  gpu::Buffer device;

  template <typename T>
  void write(const gpu::Device& on, VkCommandBuffer cmd, std::span<const T> records) {
    if (device.size_bytes < records.size_bytes() || !device.handle) {
      staging = gpu::make_buffer(on, records.size_bytes(), VK_BUFFER_USAGE_TRANSFER_SRC_BIT, gpu::Memory::upload);
      device =
          gpu::make_buffer(on, records.size_bytes(),
                           VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT, gpu::Memory::device);
    }
    if (records.empty()) return;
    std::memcpy(staging.mapped, records.data(), records.size_bytes());
    const VkBufferCopy region{.size = records.size_bytes()};
    vkCmdCopyBuffer(cmd, staging.handle, device.handle, 1, &region);
  }
};

std::array<glm::vec4, 4> columns(const glm::mat4& m) {
  return {m[0], m[1], m[2], m[3]};
}

frame::ViewConstants view_constants(const RenderSettings& settings, const glm::mat4& clip_from_world) {
  return {.clip_from_world = columns(clip_from_world),
          .world_from_clip = columns(glm::inverse(clip_from_world)),
          .eye_ws = settings.camera.eye_ws,
          .forward_ws = axes_of(settings.camera).forward,
          .ambient = settings.ambient,
          .size_px = {static_cast<float>(settings.width), static_cast<float>(settings.height)},
          .face_size_px = static_cast<float>(settings.recipe.face_size_px)};
}

}  // namespace

// What the CPU decides before anything is recorded.
struct FramePlan {
  LightList list;
  std::vector<frame::ShadowView> views;  // of all maps, then the camera's
  std::vector<Round> rounds;
  frame::ViewConstants view;
  double select_ms = 0.0;
  double project_ms = 0.0;
};

struct Renderer::Impl {
  gpu::Device& device;
  GpuScene scene;
  CullPipelines cull;
  CasterPipelines casters;
  gpu::Pipeline g_buffer;
  ShadePipelines shade;
  TonePipelines tone;
  gpu::Timers timers;

  Targets targets;
  gpu::Buffer luminance_sums;
  CubeArray store;
  DrawLists camera_draws;
  DrawLists shadow_draws;
  Streamed view, lights, maps, views;
  gpu::Buffer counters;  // one per round, then the camera's
  gpu::Buffer counters_readback;
  gpu::Buffer exposure_readback;

  Impl(gpu::Device& on, const pack::File& pack)
      : device(on),
        scene(upload_scene(on, pack)),
        cull(make_cull_pipelines(on)),
        casters(make_caster_pipelines(on, scene)),
        g_buffer(make_g_buffer_pipeline(on, scene)),
        shade(make_shade_pipelines(on)),
        tone(make_tone_pipelines(on)),
        timers(on),
        camera_draws(make_draw_lists(on, scene, scene.batch_instance_count)) {
    exposure_readback =
        gpu::make_buffer(on, sizeof(frame::LuminanceSum), VK_BUFFER_USAGE_TRANSFER_DST_BIT, gpu::Memory::readback);
  }

  FramePlan plan(const RenderSettings& settings);
  void make_room(const RenderSettings& settings, const FramePlan& plan);
  void record(VkCommandBuffer cmd, const RenderSettings& settings, const FramePlan& plan);
  void record_uploads(VkCommandBuffer cmd, const FramePlan& plan);
  void record_round(VkCommandBuffer cmd, const Recipe& recipe, const FramePlan& plan, uint32_t round);
  FrameStats read_stats(const RenderSettings& settings, const FramePlan& plan);
};

FramePlan Renderer::Impl::plan(const RenderSettings& settings) {
  const float aspect = static_cast<float>(settings.width) / static_cast<float>(settings.height);
  const glm::mat4 clip = clip_from_world(settings.camera, aspect);
  FramePlan plan;
  auto start = Clock::now();
  plan.list = select_lights(scene.lights, settings.recipe, settings.camera, aspect);
  plan.select_ms = ms_since(start);

  start = Clock::now();
  plan.views = project_lights(plan.list, settings.camera, aspect, scene.bounds, settings.recipe.face_size_px);
  const uint32_t cubes = cubes_within(device, settings.recipe.face_size_px, settings.recipe.shadow_budget_bytes);
  plan.rounds = plan_rounds(plan.list, plan.views, cubes, most_draws / std::max(1u, scene.batch_instance_count));
  plan.view = view_constants(settings, clip);
  plan.views.push_back({.clip_from_world = plan.view.clip_from_world});
  plan.project_ms = ms_since(start);
  return plan;
}

// Images and buffers that the frame needs; what is there already and large enough is kept.
void Renderer::Impl::make_room(const RenderSettings& settings, const FramePlan& plan) {
  if (targets.width != settings.width || targets.height != settings.height) {
    targets = {};
    targets = make_targets(device, settings.width, settings.height);
    luminance_sums = make_luminance_sums(device, settings.width, settings.height);
  }
  uint32_t cubes = 1;
  uint32_t views_at_once = 1;
  for (const Round& round : plan.rounds) {
    cubes = std::max(cubes, round.map_count);
    views_at_once = std::max(views_at_once, round.view_count);
  }
  if (store.face_size_px != settings.recipe.face_size_px || store.cube_count < cubes) {
    store = {};
    store = make_cube_array(device, settings.recipe.face_size_px, cubes);
    // A frame without shadow maps binds the store all the same.
    gpu::run_once(device,
                  [&](VkCommandBuffer cmd) { gpu::image_barrier(cmd, store.depth, use::nothing, use::sampled); });
  }
  const uint64_t draws = uint64_t{views_at_once} * scene.batch_instance_count;
  if (shadow_draws.capacity < draws || !shadow_draws.draws.handle) shadow_draws = make_draw_lists(device, scene, draws);
  const VkDeviceSize counter_bytes = (plan.rounds.size() + 1) * sizeof(frame::CullCounters);
  if (counters.size_bytes < counter_bytes) {
    constexpr VkBufferUsageFlags usage =
        VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT | VK_BUFFER_USAGE_TRANSFER_SRC_BIT;
    counters = gpu::make_buffer(device, counter_bytes, usage, gpu::Memory::device);
    counters_readback =
        gpu::make_buffer(device, counter_bytes, VK_BUFFER_USAGE_TRANSFER_DST_BIT, gpu::Memory::readback);
  }
}

void Renderer::Impl::record_uploads(VkCommandBuffer cmd, const FramePlan& plan) {
  view.write<frame::ViewConstants>(device, cmd, {&plan.view, 1});
  lights.write<frame::FrameLight>(device, cmd, plan.list.lights);
  maps.write<frame::ShadowMap>(device, cmd, plan.list.maps);
  views.write<frame::ShadowView>(device, cmd, plan.views);
  vkCmdFillBuffer(cmd, counters.handle, 0, VK_WHOLE_SIZE, 0);
  gpu::memory_barrier(cmd, VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT, VK_ACCESS_2_TRANSFER_WRITE_BIT,
                      VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT,
                      VK_ACCESS_2_SHADER_STORAGE_READ_BIT | VK_ACCESS_2_SHADER_STORAGE_WRITE_BIT);
}

// Draws the shadow maps of a round and adds the light of its lights.
void Renderer::Impl::record_round(VkCommandBuffer cmd, const Recipe& recipe, const FramePlan& plan, uint32_t number) {
  const Round& round = plan.rounds[number];
  timers.begin(cmd, "cull");
  record_cull(cmd, device, recipe.cull == Cull::none ? cull.none : cull.light_frustum, scene,
              {.views = views.device,
               .counters = counters,
               .first_view = round.first_view,
               .view_count = round.view_count,
               .merged_runs = std::max(1u, scene.opaque_runs),
               .round = number},
              shadow_draws);
  timers.end(cmd);

  timers.begin(cmd, "rasterize");
  record_casters(cmd, casters, scene, shadow_draws, views.device, round.view_count, store, round.map_count);
  timers.end(cmd);

  timers.begin(cmd, "shade");
  record_shade(cmd, shade, recipe,
               {.view = view.device,
                .lights = lights.device,
                .maps = maps.device,
                .views = views.device,
                .first_map = round.first_map,
                .map_count = round.map_count},
               store, targets);
  timers.end(cmd);
}

void Renderer::Impl::record(VkCommandBuffer cmd, const RenderSettings& settings, const FramePlan& plan) {
  timers.start_frame(cmd, static_cast<uint32_t>(3 * plan.rounds.size() + 2));
  record_uploads(cmd, plan);

  timers.begin(cmd, "g-buffer");
  record_cull(cmd, device, cull.light_frustum, scene,
              {.views = views.device,
               .counters = counters,
               .first_view = static_cast<uint32_t>(plan.views.size() - 1),
               .view_count = 1,
               .merged_runs = 1,
               .round = static_cast<uint32_t>(plan.rounds.size()),
               .keep_order = true},
              camera_draws);
  record_g_buffer(cmd, g_buffer, scene, camera_draws, view.device, targets);
  timers.end(cmd);

  timers.add_cpu("select", plan.select_ms);
  timers.add_cpu("project", plan.project_ms);
  for (uint32_t round = 0; round < plan.rounds.size(); ++round) record_round(cmd, settings.recipe, plan, round);

  timers.begin(cmd, "tone-map");
  record_tone_map(cmd, tone, settings.exposure_ev, luminance_sums, targets);
  timers.end(cmd);

  gpu::memory_barrier(cmd, VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT, VK_ACCESS_2_SHADER_STORAGE_WRITE_BIT,
                      VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT, VK_ACCESS_2_TRANSFER_READ_BIT);
  const VkBufferCopy counts{.size = counters.size_bytes};
  vkCmdCopyBuffer(cmd, counters.handle, counters_readback.handle, 1, &counts);
  const VkBufferCopy exposure{.size = sizeof(frame::LuminanceSum)};
  vkCmdCopyBuffer(cmd, luminance_sums.handle, exposure_readback.handle, 1, &exposure);
  gpu::memory_barrier(cmd, VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT, VK_ACCESS_2_TRANSFER_WRITE_BIT,
                      VK_PIPELINE_STAGE_2_HOST_BIT, VK_ACCESS_2_HOST_READ_BIT);
}

FrameStats Renderer::Impl::read_stats(const RenderSettings& settings, const FramePlan& plan) {
  FrameStats stats;
  for (const auto& stage : timers.read()) stats.stages.push_back({stage.name, stage.gpu_ms, stage.cpu_ms});
  frame::LuminanceSum exposure;
  std::memcpy(&exposure, exposure_readback.mapped, sizeof exposure);
  stats.exposure_ev = exposure.exposure_ev;
  stats.lights = scene.lights.size();
  stats.lights_in_view = plan.list.lights.size();
  stats.light_clusters = plan.list.maps.size();
  stats.shadow_maps = plan.list.maps.size();
  stats.shadow_views = plan.views.size() - 1;
  for (size_t i = 0; i < plan.rounds.size(); ++i) {
    frame::CullCounters round;
    std::memcpy(&round, counters_readback.mapped + i * sizeof round, sizeof round);
    stats.shadow_draws += round.draws;
    stats.shadow_triangles += round.triangles;
  }
  stats.shadow_bytes = plan.list.maps.size() * cube_bytes(settings.recipe.face_size_px);
  for (const Round& round : plan.rounds)
    stats.shadow_pool_bytes =
        std::max(stats.shadow_pool_bytes, round.map_count * cube_bytes(settings.recipe.face_size_px));
  stats.shadow_rounds = plan.rounds.size();
  return stats;
}

Renderer::Renderer(gpu::Device& device, const pack::File& pack) : impl_(std::make_unique<Impl>(device, pack)) {}
Renderer::~Renderer() = default;
Renderer::Renderer(Renderer&&) noexcept = default;
Renderer& Renderer::operator=(Renderer&&) noexcept = default;

FrameStats Renderer::draw(const RenderSettings& settings) {
  if (const auto reason = refusal(settings.recipe)) throw std::invalid_argument(*reason);
  if (settings.width == 0 || settings.height == 0) throw std::invalid_argument("a picture needs a size");
  const uint32_t largest = impl_->device.limits.maxImageDimension2D;
  if (settings.width > largest || settings.height > largest)
    throw gpu::Error("a picture of " + std::to_string(settings.width) + " x " + std::to_string(settings.height) +
                     " pixels is too large for this device (" + std::to_string(largest) + ")");
  const auto start = Clock::now();
  const FramePlan plan = impl_->plan(settings);
  impl_->make_room(settings, plan);
  gpu::run_once(impl_->device, [&](VkCommandBuffer cmd) { impl_->record(cmd, settings, plan); });
  FrameStats stats = impl_->read_stats(settings, plan);
  stats.frame_ms = ms_since(start);
  return stats;
}

void Renderer::warm_up(const RenderSettings& settings) {
  RenderSettings tiny = settings;
  tiny.width = tiny.height = 32;
  tiny.recipe.face_size_px = 16;
  draw(tiny);
  impl_->make_room(settings, impl_->plan(settings));
}

Picture Renderer::read_back() {
  const Targets& targets = impl_->targets;
  Picture picture{.width = targets.width, .height = targets.height};
  const size_t pixels = size_t{targets.width} * targets.height;
  const gpu::Buffer buffer =
      gpu::make_buffer(impl_->device, pixels * 20, VK_BUFFER_USAGE_TRANSFER_DST_BIT, gpu::Memory::readback);
  gpu::run_once(impl_->device, [&](VkCommandBuffer cmd) {
    VkBufferImageCopy copy{.imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1},
                           .imageExtent = {targets.width, targets.height, 1}};
    gpu::image_barrier(cmd, targets.radiance, use::storage, use::copied);
    vkCmdCopyImageToBuffer(cmd, targets.radiance.handle, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, buffer.handle, 1, &copy);
    gpu::image_barrier(cmd, targets.radiance, use::copied, use::storage);
    copy.bufferOffset = pixels * 16;  // behind, because an offset must be a multiple of the texel's size
    vkCmdCopyImageToBuffer(cmd, targets.shown.handle, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, buffer.handle, 1, &copy);
    gpu::memory_barrier(cmd, VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT, VK_ACCESS_2_TRANSFER_WRITE_BIT,
                        VK_PIPELINE_STAGE_2_HOST_BIT, VK_ACCESS_2_HOST_READ_BIT);
  });
  picture.shown.resize(pixels * 4);
  picture.radiance.resize(pixels * 4);
  std::memcpy(picture.radiance.data(), buffer.mapped, pixels * 16);
  std::memcpy(picture.shown.data(), buffer.mapped + pixels * 16, pixels * 4);
  return picture;
}

VkImage Renderer::shown_image() const {
  return impl_->targets.shown.handle;
}

}  // namespace chandelier
