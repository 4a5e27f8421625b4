// SPDX-License-Identifier: Apache-2.0
// A frame: its stages in order, barriers in sight.
#include "frame/renderer.h"

#include <volk.h>

#include <algorithm>
#include <chrono>
#include <cstring>

#include "frame/frame_plan.h"
#include "frame/ray_visibility.h"
#include "frame/targets.h"
#include "gpu/timers.h"
#include "lookup/tiles.h"
#include "scene/gpu_scene.h"
#include "shading/g_buffer.h"
#include "shading/shade.h"
#include "shading/tone_map.h"
#include "shadows/raster/caster_pass.h"

namespace chandelier {
namespace {

using Clock = std::chrono::steady_clock;
double ms_since(Clock::time_point start) {
  return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

// A list that the CPU writes and shaders read, every frame anew.
struct Streamed {
  gpu::Buffer staging;
  gpu::Buffer device;

  template <typename T>
  void write(const gpu::Device& on, gpu::Commands cmd, std::span<const T> records) {
    if (device.size_bytes < records.size_bytes() || !device.handle) {
      staging = gpu::make_buffer(on, records.size_bytes(), VK_BUFFER_USAGE_TRANSFER_SRC_BIT, gpu::Memory::upload);
      device =
          gpu::make_buffer(on, records.size_bytes(),
                           VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT, gpu::Memory::device);
    }
    if (records.empty()) return;
    std::memcpy(staging.mapped, records.data(), records.size_bytes());
    const VkBufferCopy region{.size = records.size_bytes()};
    cmd->vkCmdCopyBuffer(cmd, staging.handle, device.handle, 1, &region);
  }
};

// As uploaded.
size_t light_count(const FramePlan& plan) {
  return plan.list.lights.size() + plan.list.shadowless.size();
}

}  // namespace

struct Renderer::Impl {
  gpu::Device& device;
  Surroundings surroundings;
  GpuScene scene;
  CullPipelines cull;
  CasterPipelines casters;
  gpu::Pipeline g_buffer;
  TilePipeline tile_pipeline;
  ShadePipelines shade;
  TonePipelines tone;
  gpu::Timers timers;

  Targets targets;
  gpu::Buffer luminance_sums;
  CubeArray store;
  DrawLists camera_draws;
  DrawLists shadow_draws;
  Streamed view, lights, maps, views;
  TileLists tiles;
  gpu::Buffer visibility;
  gpu::Buffer counters;  // one per round, then the camera's
  gpu::Buffer counters_readback;
  gpu::Buffer exposure_readback;

  Impl(gpu::Device& on, const pack::File& file)
      : device(on),
        surroundings(file.view()),
        scene(upload_scene(on, file)),
        cull(make_cull_pipelines(on)),
        casters(make_caster_pipelines(on, scene)),
        g_buffer(make_g_buffer_pipeline(on, scene)),
        tile_pipeline(make_tile_pipeline(on)),
        shade(make_shade_pipelines(on)),
        tone(make_tone_pipelines(on)),
        timers(on),
        camera_draws(make_draw_lists(on, scene, scene.batch_instance_count)) {
    exposure_readback =
        gpu::make_buffer(on, sizeof(frame::LuminanceSum), VK_BUFFER_USAGE_TRANSFER_DST_BIT, gpu::Memory::readback);
  }

  FramePlan plan(const RenderSettings& settings);
  void make_room(const RenderSettings& settings, const FramePlan& plan);
  void record_uploads(gpu::Commands cmd, const FramePlan& plan);
  void record_start(gpu::Commands cmd, const FramePlan& plan);
  void record_shadow_maps(gpu::Commands cmd, const FramePlan& plan, uint32_t round);
  void record_light(gpu::Commands cmd, const FramePlan& plan, const Round& round);
  void record_end(gpu::Commands cmd, const RenderSettings& settings);
  void draw(const RenderSettings& settings, const FramePlan& plan);
  void draw_by_rays(const RenderSettings& settings, const FramePlan& plan);
  FrameStats read_stats(const RenderSettings& settings, const FramePlan& plan);
};

FramePlan Renderer::Impl::plan(const RenderSettings& settings) {
  const uint64_t batch_instances = std::max(1u, scene.batch_instance_count);
  return plan_frame(scene.lights, scene.bounds, settings,
                    {.maps = cubes_within(device, settings.recipe.face_size_px, settings.recipe.shadow_budget_bytes),
                     .views = most_draws_of_round / batch_instances,
                     .visibility_bytes = device.limits.maxStorageBufferRange},
                    &surroundings);
}

// Images and buffers that the frame needs; what is there already and large enough is kept.
void Renderer::Impl::make_room(const RenderSettings& settings, const FramePlan& plan) {
  if (targets.width != settings.width || targets.height != settings.height) {
    targets = {};
    targets = make_targets(device, settings.width, settings.height);
    luminance_sums = make_luminance_sums(device, settings.width, settings.height);
  }
  const bool by_rays = plan.recipe.filter == Filter::rays;
  uint32_t cubes = 1;
  uint32_t views_at_once = 1;
  uint64_t visibility_bytes = 0;
  for (const Round& round : plan.rounds) {
    if (!by_rays) cubes = std::max(cubes, round.map_count);
    views_at_once = std::max(views_at_once, round.view_count);
    visibility_bytes = std::max(visibility_bytes, round.visibility_bytes);
  }
  if (plan.recipe.lookup == Lookup::tiles)
    make_tile_lists(device, settings.width, settings.height, light_count(plan), tiles);
  if (visibility_bytes > device.limits.maxStorageBufferRange)
    throw gpu::Error("a picture of " + std::to_string(settings.width) + " x " + std::to_string(settings.height) +
                     " pixels is too large for visibility textures on this device; use deliver inline");
  if (!visibility.handle || visibility.size_bytes < visibility_bytes || by_rays == !visibility.mapped)
    visibility = gpu::make_buffer(device, visibility_bytes, VK_BUFFER_USAGE_STORAGE_BUFFER_BIT,
                                  by_rays ? gpu::Memory::upload : gpu::Memory::device);
  if (store.face_size_px != settings.recipe.face_size_px || store.cube_count < cubes) {
    store = {};
    store = make_cube_array(device, settings.recipe.face_size_px, cubes);
    // A frame without shadow maps binds the store all the same.
    gpu::run_once(device, [&](gpu::Commands cmd) { gpu::image_barrier(cmd, store.depth, use::nothing, use::sampled); });
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

void Renderer::Impl::record_uploads(gpu::Commands cmd, const FramePlan& plan) {
  view.write<frame::ViewConstants>(device, cmd, {&plan.view, 1});
  std::vector<frame::FrameLight> all_lights = plan.list.lights;
  all_lights.insert(all_lights.end(), plan.list.shadowless.begin(), plan.list.shadowless.end());
  lights.write<frame::FrameLight>(device, cmd, all_lights);
  maps.write<frame::ShadowMap>(device, cmd, plan.list.maps);
  views.write<frame::ShadowView>(device, cmd, plan.views);
  cmd->vkCmdFillBuffer(cmd, counters.handle, 0, VK_WHOLE_SIZE, 0);
  gpu::memory_barrier(cmd, VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT, VK_ACCESS_2_TRANSFER_WRITE_BIT,
                      VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT,
                      VK_ACCESS_2_SHADER_STORAGE_READ_BIT | VK_ACCESS_2_SHADER_STORAGE_WRITE_BIT);
}

// What the camera sees, and which lights reach it.
void Renderer::Impl::record_start(gpu::Commands cmd, const FramePlan& plan) {
  timers.start_frame(cmd, static_cast<uint32_t>(4 * plan.rounds.size() + 3));
  record_uploads(cmd, plan);
  timers.add_cpu("select", plan.select_ms);
  timers.add_cpu("project", plan.project_ms);

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

  if (plan.recipe.lookup == Lookup::tiles) {
    timers.begin(cmd, "lookup");
    record_tiles(cmd, tile_pipeline, view.device, lights.device, light_count(plan), targets, tiles);
    timers.end(cmd);
  }
}

// Draws the shadow maps of a round.
void Renderer::Impl::record_shadow_maps(gpu::Commands cmd, const FramePlan& plan, uint32_t number) {
  const Round& round = plan.rounds[number];
  timers.begin(cmd, "cull");
  record_cull(cmd, device, plan.recipe.cull == Cull::none ? cull.none : cull.light_frustum, scene,
              {.views = views.device,
               .counters = counters,
               .first_view = round.first_view,
               .view_count = round.view_count,
               .merged_runs = std::max(1u, scene.opaque_runs),
               .round = number,
               .casters_only = true},
              shadow_draws);
  timers.end(cmd);

  timers.begin(cmd, "rasterize");
  record_casters(cmd, casters, scene, shadow_draws, views.device, round.view_count, store, round.map_count);
  timers.end(cmd);
}

// Adds the light of a round's lights. Where visibility comes from rays it is in `visibility` already.
void Renderer::Impl::record_light(gpu::Commands cmd, const FramePlan& plan, const Round& round) {
  ShadeInput input{.view = view.device,
                   .lights = lights.device,
                   .maps = maps.device,
                   .views = views.device,
                   .visibility = visibility,
                   .tiles = tiles,
                   .first_light = round.first_light,
                   .light_count = round.light_count};
  if (plan.recipe.deliver == Deliver::textures && plan.recipe.filter != Filter::rays) {
    timers.begin(cmd, "deliver");
    record_visibility(cmd, device, shade, plan.recipe, input, store, targets);
    timers.end(cmd);
  }
  input.light_count += round.shadowless_count;
  timers.begin(cmd, "shade");
  record_shade(cmd, device, shade, plan.recipe, input, store, targets);
  timers.end(cmd);
}

// The picture as shown, and the counters.
void Renderer::Impl::record_end(gpu::Commands cmd, const RenderSettings& settings) {
  timers.begin(cmd, "tone-map");
  record_tone_map(cmd, tone, settings.exposure_ev, luminance_sums, targets);
  timers.end(cmd);

  gpu::memory_barrier(cmd, VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT, VK_ACCESS_2_SHADER_STORAGE_WRITE_BIT,
                      VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT, VK_ACCESS_2_TRANSFER_READ_BIT);
  const VkBufferCopy counts{.size = counters.size_bytes};
  cmd->vkCmdCopyBuffer(cmd, counters.handle, counters_readback.handle, 1, &counts);
  const VkBufferCopy exposure{.size = sizeof(frame::LuminanceSum)};
  cmd->vkCmdCopyBuffer(cmd, luminance_sums.handle, exposure_readback.handle, 1, &exposure);
  gpu::memory_barrier(cmd, VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT, VK_ACCESS_2_TRANSFER_WRITE_BIT,
                      VK_PIPELINE_STAGE_2_HOST_BIT, VK_ACCESS_2_HOST_READ_BIT);
}

void Renderer::Impl::draw(const RenderSettings& settings, const FramePlan& plan) {
  gpu::run_once(device, [&](gpu::Commands cmd) {
    record_start(cmd, plan);
    for (uint32_t round = 0; round < plan.rounds.size(); ++round) {
      if (plan.rounds[round].map_count > 0) record_shadow_maps(cmd, plan, round);
      record_light(cmd, plan, plan.rounds[round]);
    }
    record_end(cmd, settings);
  });
}

// The caller's rays stand between the device's work: first what the camera sees, then each round's light.
void Renderer::Impl::draw_by_rays(const RenderSettings& settings, const FramePlan& plan) {
  const gpu::Buffer readback = make_surface_readback(device, settings.width, settings.height);
  gpu::run_once(device, [&](gpu::Commands cmd) {
    record_start(cmd, plan);
    record_read_surfaces(cmd, targets, readback);
  });
  const auto points = surface_points(readback, plan.view);
  const std::span<uint8_t> bytes(reinterpret_cast<uint8_t*>(visibility.mapped), visibility.size_bytes);
  for (const Round& round : plan.rounds) {
    const auto start = Clock::now();
    fill_visibility(plan, round, points, settings.width, settings.visibility, bytes);
    timers.add_cpu("filter", ms_since(start));
    gpu::run_once(device, [&](gpu::Commands cmd) { record_light(cmd, plan, round); });
  }
  gpu::run_once(device, [&](gpu::Commands cmd) { record_end(cmd, settings); });
}

FrameStats Renderer::Impl::read_stats(const RenderSettings& settings, const FramePlan& plan) {
  FrameStats stats = planned_stats(plan, settings, scene.lights.size());
  for (const auto& stage : timers.read()) stats.stages.push_back({stage.name, stage.gpu_ms, stage.cpu_ms});
  frame::LuminanceSum exposure;
  std::memcpy(&exposure, exposure_readback.mapped, sizeof exposure);
  stats.exposure_ev = exposure.exposure_ev;
  for (size_t i = 0; i < plan.rounds.size(); ++i) {
    frame::CullCounters round;
    std::memcpy(&round, counters_readback.mapped + i * sizeof round, sizeof round);
    stats.shadow_draws += round.draws;
    stats.shadow_triangles += round.triangles;
  }
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
  if (settings.recipe.filter == Filter::rays && !settings.visibility)
    throw std::invalid_argument("filter rays: nothing says what is visible (RenderSettings::visibility)");
  const auto start = Clock::now();
  const FramePlan plan = impl_->plan(settings);
  impl_->make_room(settings, plan);
  if (plan.recipe.filter == Filter::rays)
    impl_->draw_by_rays(settings, plan);
  else
    impl_->draw(settings, plan);
  FrameStats stats = impl_->read_stats(settings, plan);
  stats.frame_ms = ms_since(start);
  return stats;
}

void Renderer::warm_up(const RenderSettings& settings) {
  RenderSettings tiny = settings;
  tiny.width = tiny.height = 32;
  tiny.recipe.face_size_px = 16;
  if (tiny.recipe.select == Select::error_driven) tiny.recipe.select = Select::per_light;  // not to look at 32 x 32
  draw(tiny);
  impl_->make_room(settings, impl_->plan(settings));
}

Picture Renderer::read_back() {
  return read_picture(impl_->device, impl_->targets);
}

VkImage Renderer::shown_image() const {
  return impl_->targets.shown.handle;
}

}  // namespace chandelier
