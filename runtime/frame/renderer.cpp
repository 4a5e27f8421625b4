// SPDX-License-Identifier: Apache-2.0
// A frame: its stages in order, barriers in sight.
#include "frame/renderer.h"

#include <volk.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstring>
#include <map>

#include "frame/frame_resources.h"
#include "scene/world_changes.h"
#include "shading/g_buffer.h"
#include "shading/shade.h"
#include "shading/tone_map.h"
#include "shadows/filter/ray_visibility.h"
#include "shadows/raster/caster_pass.h"

namespace chandelier {
namespace {

using Clock = std::chrono::steady_clock;
double ms_since(Clock::time_point start) {
  return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

constexpr uint64_t most_edge_visibility_bytes = uint64_t{64} << 20;  // held at a time, by filter rays

constexpr float anisotropy_on_gpus = 8.0f;

// Mesa's software drivers take many times as long for an anisotropic fetch.
float anisotropy_on(const gpu::Device& device, const RendererOptions& options) {
  return options.anisotropy.value_or(device.is_software ? 1.0f : anisotropy_on_gpus);
}

// What was decided for the settings of a frame. Recorded frames that ask for the same take it again.
struct Planned {
  RenderSettings settings;
  Version world_version = 0;
  FramePlan plan;
  FrameStats stats;
  bool is_there = false;
  bool is_placed = false;  // its maps have places, which stay unless maps are kept
};

// A frame that is being recorded.
struct Recording {
  gpu::Commands cmd;
  FrameSlot& slot;
  const RenderSettings& settings;
  const FramePlan& plan;
};

// Times a stage as long as it lives.
class Timed {
 public:
  Timed(const Recording& frame, const char* stage) : frame_(frame) { frame.slot.timers.begin(frame.cmd, stage); }
  ~Timed() { frame_.slot.timers.end(frame_.cmd); }
  Timed(const Timed&) = delete;
  Timed& operator=(const Timed&) = delete;

 private:
  const Recording& frame_;
};

// Everything of this frame after everything of the frame before, which used the same images and buffers.
void wait_for_frame_before(gpu::Commands cmd) {
  gpu::memory_barrier(cmd, VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT, VK_ACCESS_2_MEMORY_WRITE_BIT,
                      VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT, VK_ACCESS_2_MEMORY_READ_BIT | VK_ACCESS_2_MEMORY_WRITE_BIT);
}

void check_settings(const gpu::Device& device, const RenderSettings& settings) {
  if (const auto reason = refusal(settings.recipe)) throw std::invalid_argument(*reason);
  if (settings.width == 0 || settings.height == 0) throw std::invalid_argument("a picture needs a size");
  const uint32_t largest = device.limits.maxImageDimension2D;
  if (!can_draw_samples(device, settings.samples))
    throw gpu::Error(std::to_string(settings.samples) + " samples in a pixel: this device cannot draw them");
  if (settings.width > largest || settings.height > largest)
    throw gpu::Error("a picture of " + std::to_string(settings.width) + " x " + std::to_string(settings.height) +
                     " pixels is too large for this device (" + std::to_string(largest) + ")");
}

}  // namespace

// What frames with one number of samples in a pixel are drawn with.
struct SamplePipelines {
  gpu::Pipeline g_buffer;
  EdgePipelines edges;
};

struct Renderer::Impl {
  gpu::Device& device;
  const World& world;
  Surroundings surroundings;
  GpuScene scene;
  CullPipelines camera_cull;
  std::map<Cull, CullPipelines> cull;  // made when first needed
  CasterPipelines casters;
  gpu::Pipeline g_buffer;
  std::map<uint32_t, SamplePipelines> of_samples;  // 2 or more; made when first needed
  TilePipeline tile_pipeline;
  ShadePipelines shade;
  TonePipelines tone;
  FrameResources resources;
  std::vector<FrameSlot> slots;
  Planned planned;
  bool is_drawn = false;

  Impl(gpu::Device& on, const World& of, const RendererOptions& options)
      : device(on),
        world(of),
        surroundings(of),
        scene(upload_scene(on, of, {anisotropy_on(on, options), options.upload_progress})),
        camera_cull(make_cull_pipelines(on, Cull::light_frustum, true)),
        casters(make_caster_pipelines(on, scene)),
        g_buffer(make_g_buffer_pipeline(on, scene, 1)),
        tile_pipeline(make_tile_pipeline(on)),
        shade(make_shade_pipelines(on)),
        tone(make_tone_pipelines(on)) {
    gpu::Uploader uploader(on, 0, {});
    resources.camera_draws = make_cull_state(on, uploader, lists_by_material(of.pack()));
    resources.shadow_draws = make_cull_state(on, uploader, lists_for_shadows(of.pack()));
    uploader.finish();
    for (uint32_t i = 0; i < std::max(1u, options.frames_in_flight); ++i) slots.emplace_back(on);
  }

  bool has_planned(const RenderSettings& settings) const;
  void plan(const RenderSettings& settings);
  uint64_t place_maps(const RenderSettings& settings);
  Recording prepare(gpu::Commands cmd, FrameSlot& slot, const RenderSettings& settings);
  void record(const Recording& frame);
  FrameStats draw(FrameSlot& slot, const RenderSettings& settings);
  void draw_by_rays(FrameSlot& slot, const RenderSettings& settings);
  const FrameStats& read_stats(FrameSlot& slot);
  void check_drawn() const;

  void record_device_plan(const Recording& frame);
  void record_start(const Recording& frame);
  void record_uploads(const Recording& frame);
  void record_shadow_maps(const Recording& frame, uint32_t group);
  void record_light(const Recording& frame, const MapGroup& group);
  void light_edges_by_rays(const Recording& frame, const MapGroup& group, std::span<const SurfacePoint> points);
  const SamplePipelines& pipelines_of(uint32_t samples);
  Edges edges(const Recording& frame);
  ShadeInput shade_input(const FramePlan& plan, const MapGroup& group) const;
  void record_end(const Recording& frame);
  void record_target(gpu::Commands cmd, const Target& target);
};

bool Renderer::Impl::has_planned(const RenderSettings& settings) const {
  return planned.is_there && planned.world_version == world.version() && planned.settings == settings &&
         !(planned.stats.selection_is_provisional && surroundings.has_news());
}

void Renderer::Impl::plan(const RenderSettings& settings) {
  planned.is_there = planned.is_placed = false;
  planned.plan =
      plan_frame(world, settings,
                 {.cubes = cubes_within(device, settings.recipe.face_size_px, settings.recipe.shadow_budget_bytes),
                  .layer_size_px = settings.recipe.face_size_px,
                  .views = most_views(scene.batch_instance_count, settings.most_caster_draws),
                  .visibility_bytes = device.limits.maxStorageBufferRange},
                 &surroundings);
  planned.stats = planned_stats(world, planned.plan, settings);
  planned.settings = settings;
  planned.world_version = world.version();
  planned.is_there = true;
}

// Finds places in the store for the plan's maps, and returns how many are there already.
uint64_t Renderer::Impl::place_maps(const RenderSettings& settings) {
  FramePlan& plan = planned.plan;
  KeptMaps& maps = resources.store.maps;
  const bool has_places = std::exchange(planned.is_placed, true) && !settings.keep_shadow_maps;
  if (has_places || plan.recipe.filter == Filter::rays) return 0;
  for (const MapGroup& group : plan.groups) {
    if (!settings.keep_shadow_maps) maps.forget();
    maps.place(group, world, plan.list, plan.views);
  }
  return static_cast<uint64_t>(std::ranges::count(plan.list.maps, 1u, &frame::ShadowMap::is_kept));
}

// Takes the plan and makes room for it. The frame that used the slot has finished.
Recording Renderer::Impl::prepare(gpu::Commands cmd, FrameSlot& slot, const RenderSettings& settings) {
  slot.reset();
  make_room(device, settings, planned.plan, slot, resources);
  slot.stats = planned.stats;
  slot.stats.shadow_maps_kept = place_maps(settings);
  slot.stats.sample_bytes =
      resources.edges.size_bytes + sample_target_bytes(settings.width, settings.height, settings.samples);
  slot.groups = planned.plan.groups.size();
  slot.is_read = false;
  return {cmd, slot, settings, planned.plan};
}

void Renderer::Impl::record_uploads(const Recording& frame) {
  const auto& [cmd, slot, settings, plan] = frame;
  record_world_changes(cmd, world, scene);
  const auto write = [&, &slot = slot]<typename T>(gpu::Streamed& to, std::initializer_list<std::span<const T>> parts) {
    to.write(device, frame.cmd, slot.uploads, slot.retired, parts);
  };
  write.operator()<frame::ViewConstants>(resources.view, {{&plan.view, 1}});
  write.operator()<frame::FrameLight>(resources.lights, {plan.list.lights, plan.list.shadowless});
  write.operator()<frame::ShadowMap>(resources.maps, {plan.list.maps});
  write.operator()<frame::ShadowView>(resources.views, {plan.views});
  cmd->vkCmdFillBuffer(cmd, resources.counters.handle, 0, VK_WHOLE_SIZE, 0);
  // A frame without shadow maps binds the store all the same.
  if (std::exchange(resources.store.is_new, false))
    gpu::image_barrier(cmd, resources.store.depth, use::nothing, use::sampled);
  gpu::memory_barrier(cmd, VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT, VK_ACCESS_2_TRANSFER_WRITE_BIT,
                      VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT,
                      VK_ACCESS_2_SHADER_STORAGE_READ_BIT | VK_ACCESS_2_SHADER_STORAGE_WRITE_BIT);
}

// What the device decides for itself, once it has drawn what the camera sees: nothing is read back.
void Renderer::Impl::record_device_plan(const Recording& frame) {
  const auto& [cmd, slot, settings, plan] = frame;
  switch (plan.recipe.lookup) {
    case Lookup::all:
      return;
    case Lookup::tiles: {
      const Timed timed(frame, "lookup");
      record_tiles(cmd, tile_pipeline, resources.view.buffer(), resources.lights.buffer(), light_count(plan),
                   resources.targets, settings.samples > 1 ? &resources.edges.tiles : nullptr, resources.tiles);
      return;
    }
  }
}

const SamplePipelines& Renderer::Impl::pipelines_of(uint32_t samples) {
  const auto found = of_samples.find(samples);
  if (found != of_samples.end()) return found->second;
  SamplePipelines made{make_g_buffer_pipeline(device, scene, samples), make_edge_pipelines(device, samples)};
  return of_samples.emplace(samples, std::move(made)).first->second;
}

Edges Renderer::Impl::edges(const Recording& frame) {
  const RenderSettings& settings = frame.settings;
  const float pixel_angle = 2.0f * std::tan(0.5f * settings.camera.yfov_rad) / static_cast<float>(settings.height);
  return {pipelines_of(settings.samples).edges, resources.edges, resources.targets, pixel_angle};
}

// What the camera sees, and which lights reach it.
void Renderer::Impl::record_start(const Recording& frame) {
  const auto& [cmd, slot, settings, plan] = frame;
  wait_for_frame_before(cmd);
  slot.timers.start_frame(cmd, static_cast<uint32_t>(4 * plan.groups.size() + 3));
  record_uploads(frame);
  slot.timers.add_cpu("select", plan.select_ms);
  slot.timers.add_cpu("project", plan.project_ms);
  {
    const Timed timed(frame, "g-buffer");
    const CullInput camera{.views = resources.views.buffer(),
                           .maps = resources.maps.buffer(),
                           .counters = resources.counters,
                           .first_map = static_cast<uint32_t>(plan.views.size() - 1),
                           .map_count = 1,
                           .view_count = 1,
                           .group = static_cast<uint32_t>(plan.groups.size())};
    record_boxes(cmd, device, camera_cull, scene, camera, resources.camera_draws);
    record_cull(cmd, device, camera_cull, scene, camera, resources.camera_draws);
    const bool has_samples = settings.samples > 1;
    const gpu::Pipeline& pipeline = has_samples ? pipelines_of(settings.samples).g_buffer : g_buffer;
    record_g_buffer(cmd, pipeline, scene, resources.camera_draws, resources.view.buffer(), resources.targets);
    if (has_samples) record_find_edges(cmd, edges(frame));
  }
  record_device_plan(frame);
}

// Draws the shadow maps of a group.
void Renderer::Impl::record_shadow_maps(const Recording& frame, uint32_t number) {
  const auto& [cmd, slot, settings, plan] = frame;
  const MapGroup& group = plan.groups[number];
  const Cull answer = plan.recipe.cull;
  if (!cull.contains(answer)) cull.emplace(answer, make_cull_pipelines(device, answer, false));
  const CullPipelines& culling = cull.at(answer);
  const CullState& culled = resources.shadow_draws;
  const CullInput input{.views = resources.views.buffer(),
                        .maps = resources.maps.buffer(),
                        .counters = resources.counters,
                        .first_map = group.first_map,
                        .map_count = group.map_count,
                        .view_count = group.view_count,
                        .group = number};
  uint32_t passes = 1;
  {
    const Timed timed(frame, "cull");
    if (number == 0) record_boxes(cmd, device, culling, scene, input, culled);
    passes = record_cull(cmd, device, culling, scene, input, culled);
  }
  const Timed timed(frame, "rasterize");
  const CasterInput drawn{.culled = culled,
                          .views = input.views,
                          .store = resources.store,
                          .maps = std::span(plan.list.maps).subspan(group.first_map, group.map_count),
                          .cube_count = group.cube_count,
                          .keeps = settings.keep_shadow_maps};
  begin_casters(cmd, drawn);
  for (uint32_t pass = 0; pass < passes; ++pass) {
    if (pass > 0) record_append(cmd, culling, scene, input, culled, pass);
    record_casters(cmd, casters, scene, drawn, pass);
  }
  end_casters(cmd, drawn);
}

ShadeInput Renderer::Impl::shade_input(const FramePlan& plan, const MapGroup& group) const {
  return {.view = resources.view.buffer(),
          .lights = resources.lights.buffer(),
          .maps = resources.maps.buffer(),
          .views = resources.views.buffer(),
          .visibility = resources.visibility,
          .tiles = resources.tiles,
          .first_light = group.first_light,
          .light_count = group.light_count,
          .projections = projections_of(plan.list.maps),
          .parts_of_layers = has_parts_of_layers(plan.list.maps, resources.store)};
}

// Adds the light of a group's lights. Where visibility comes from rays it is in `visibility` already; that of edges
// follows.
void Renderer::Impl::record_light(const Recording& frame, const MapGroup& group) {
  const auto& [cmd, slot, settings, plan] = frame;
  ShadeInput input = shade_input(plan, group);
  if (plan.recipe.deliver == Deliver::textures && plan.recipe.filter != Filter::rays) {
    const Timed timed(frame, "deliver");
    record_visibility(cmd, device, shade, plan.recipe, input, resources.store, resources.targets);
  }
  input.light_count += group.shadowless_count;
  const Timed timed(frame, "shade");
  record_shade(cmd, device, shade, plan.recipe, input, resources.store, resources.targets);
  if (settings.samples > 1 && plan.recipe.filter != Filter::rays)
    record_shade_edges(cmd, device, shade, plan.recipe, input, resources.store, edges(frame));
}

// The picture as shown, and the counters.
void Renderer::Impl::record_end(const Recording& frame) {
  const auto& [cmd, slot, settings, plan] = frame;
  {
    const Timed timed(frame, "tone-map");
    const bool has_samples = settings.samples > 1;
    if (has_samples) record_resolve(cmd, edges(frame));
    record_tone_map(cmd, tone, settings.exposure_ev, resources.luminance_sums, resources.targets);
    if (has_samples) record_resolve_shown(cmd, edges(frame), resources.luminance_sums);
  }
  is_drawn = true;
  gpu::memory_barrier(cmd, VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT, VK_ACCESS_2_SHADER_STORAGE_WRITE_BIT,
                      VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT, VK_ACCESS_2_TRANSFER_READ_BIT);
  const VkBufferCopy counts{.size = (plan.groups.size() + 1) * sizeof(frame::CullCounters)};
  cmd->vkCmdCopyBuffer(cmd, resources.counters.handle, slot.counters.handle, 1, &counts);
  const VkBufferCopy exposure{.size = sizeof(frame::LuminanceSum)};
  cmd->vkCmdCopyBuffer(cmd, resources.luminance_sums.handle, slot.exposure.handle, 1, &exposure);
  const VkBufferCopy edge_counts{.size = sizeof(frame::EdgeCounters)};
  if (settings.samples > 1)
    cmd->vkCmdCopyBuffer(cmd, resources.edges.counters.handle, slot.edges.handle, 1, &edge_counts);
  gpu::memory_barrier(cmd, VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT, VK_ACCESS_2_TRANSFER_WRITE_BIT,
                      VK_PIPELINE_STAGE_2_HOST_BIT, VK_ACCESS_2_HOST_READ_BIT);
}

void Renderer::Impl::record(const Recording& frame) {
  const FramePlan& plan = frame.plan;
  const Version uploaded = scene.instances_version;
  const bool store_is_new = resources.store.is_new;
  try {
    record_start(frame);
    for (uint32_t group = 0; group < plan.groups.size(); ++group) {
      if (plan.groups[group].map_count > 0) record_shadow_maps(frame, group);
      record_light(frame, plan.groups[group]);
    }
    record_end(frame);
  } catch (...) {  // what was recorded is lost: the next frame does it again
    scene.instances_version = uploaded;
    resources.store.is_new = store_is_new;
    resources.store.maps.forget();
    throw;
  }
}

void Renderer::Impl::record_target(gpu::Commands cmd, const Target& target) {
  gpu::image_barrier(cmd, target.image, use::nothing, use::copied_to);
  const auto corner = [](uint32_t width, uint32_t height) {
    return VkOffset3D{static_cast<int32_t>(width), static_cast<int32_t>(height), 1};
  };
  constexpr VkImageSubresourceLayers whole{VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1};
  const VkImageBlit blit{.srcSubresource = whole,
                         .srcOffsets = {{}, corner(resources.targets.width, resources.targets.height)},
                         .dstSubresource = whole,
                         .dstOffsets = {{}, corner(target.size.width, target.size.height)}};
  cmd->vkCmdBlitImage(cmd, resources.targets.shown.handle, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, target.image,
                      VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, 1, &blit, VK_FILTER_LINEAR);
  gpu::image_barrier(cmd, target.image, use::copied_to,
                     {target.layout_after, VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT, VK_ACCESS_2_MEMORY_READ_BIT});
}

FrameStats Renderer::Impl::draw(FrameSlot& slot, const RenderSettings& settings) {
  const auto start = Clock::now();
  plan(settings);
  if (planned.plan.recipe.filter == Filter::rays)
    draw_by_rays(slot, settings);
  else
    gpu::run_once(device, [&](gpu::Commands cmd) { record(prepare(cmd, slot, settings)); });
  FrameStats stats = read_stats(slot);
  stats.frame_ms = ms_since(start);
  slot.reset();
  return stats;
}

// The caller's rays stand between the device's work: first what the camera sees, then each group's light.
void Renderer::Impl::draw_by_rays(FrameSlot& slot, const RenderSettings& settings) {
  const gpu::Buffer readback = make_surface_readback(device, settings.width, settings.height);
  gpu::run_once(device, [&](gpu::Commands cmd) {
    record_start(prepare(cmd, slot, settings));
    record_read_surfaces(cmd, resources.targets, readback);
  });
  const FramePlan& plan = planned.plan;
  const auto points = surface_points(readback, plan.view);
  std::vector<SurfacePoint> edge_points;
  if (settings.samples > 1)
    edge_points =
        read_edge_points(device, edges({{device, VK_NULL_HANDLE}, slot, settings, plan}), resources.view.buffer());
  const gpu::Buffer& visibility = resources.visibility;
  const std::span<uint8_t> bytes(reinterpret_cast<uint8_t*>(visibility.mapped), visibility.size_bytes);
  for (const MapGroup& group : plan.groups) {
    const auto start = Clock::now();
    fill_visibility(plan, group, points, settings.width, settings.visibility, bytes);
    slot.timers.add_cpu("filter", ms_since(start));
    gpu::run_once(device, [&](gpu::Commands cmd) { record_light({cmd, slot, settings, plan}, group); });
    light_edges_by_rays({{device, VK_NULL_HANDLE}, slot, settings, plan}, group, edge_points);
  }
  gpu::run_once(device, [&](gpu::Commands cmd) { record_end({cmd, slot, settings, plan}); });
}

// In parts whose visibility fits a buffer.
void Renderer::Impl::light_edges_by_rays(const Recording& frame, const MapGroup& group,
                                         std::span<const SurfacePoint> points) {
  if (points.empty()) return;
  const auto& [none, slot, settings, plan] = frame;
  const uint64_t maps = std::max<uint64_t>(group.map_count, 1);
  const uint64_t most = std::clamp<uint64_t>(most_edge_visibility_bytes / maps, 1, points.size());
  const gpu::Buffer visibility =
      gpu::make_buffer(device, most * maps, VK_BUFFER_USAGE_STORAGE_BUFFER_BIT, gpu::Memory::upload);
  const std::span<uint8_t> bytes(reinterpret_cast<uint8_t*>(visibility.mapped), visibility.size_bytes);
  for (size_t first = 0; first < points.size(); first += most) {
    const auto part = points.subspan(first, std::min<size_t>(most, points.size() - first));
    const auto start = Clock::now();
    fill_edge_visibility(plan, group, part, settings.visibility, bytes);
    slot.timers.add_cpu("filter", ms_since(start));
    const ShadeInput whole = shade_input(plan, group);
    const ShadeInput input{
        whole.view,        whole.lights,         whole.maps,        whole.views,
        visibility,        whole.tiles,          group.first_light, group.light_count + group.shadowless_count,
        whole.projections, whole.parts_of_layers};
    gpu::run_once(device, [&](gpu::Commands cmd) {
      record_shade_edges(cmd, device, shade, plan.recipe, input, resources.store, edges(frame),
                         {static_cast<uint32_t>(first), static_cast<uint32_t>(part.size())});
    });
  }
}

void Renderer::Impl::check_drawn() const {
  if (!is_drawn) throw std::logic_error("no frame has been drawn yet");
}

const FrameStats& Renderer::Impl::read_stats(FrameSlot& slot) {
  if (slot.is_read) return slot.stats;
  FrameStats& stats = slot.stats;
  const auto stages = slot.timers.read();  // throws where the frame has not finished
  slot.is_read = true;
  stats.frame_ms = slot.record_ms;
  for (const auto& stage : stages) {
    stats.stages.push_back({stage.name, stage.gpu_ms, stage.cpu_ms});
    stats.frame_ms += stage.gpu_ms;
  }
  frame::LuminanceSum exposure;
  std::memcpy(&exposure, slot.exposure.mapped, sizeof exposure);
  stats.exposure_ev = exposure.exposure_ev;
  if (stats.sample_bytes > 0) {
    frame::EdgeCounters edges;
    std::memcpy(&edges, slot.edges.mapped, sizeof edges);
    stats.edge_pixels = edges.pixels;
    stats.edge_surfaces = edges.surfaces;
  }
  for (size_t i = 0; i < slot.groups; ++i) {
    frame::CullCounters group;
    std::memcpy(&group, slot.counters.mapped + i * sizeof group, sizeof group);
    stats.shadow_draws += group.draws;
    stats.shadow_triangles += group.triangles + (uint64_t{group.triangles_high} << 32);
    stats.shadow_overflow_passes += group.further_passes;
  }
  return stats;
}

Renderer::Renderer(gpu::Device& device, const World& world, const RendererOptions& options)
    : impl_(std::make_unique<Impl>(device, world, options)) {}
Renderer::~Renderer() = default;
Renderer::Renderer(Renderer&&) noexcept = default;
Renderer& Renderer::operator=(Renderer&&) noexcept = default;

const FrameStats& Renderer::record(VkCommandBuffer cmd, uint32_t slot, const RenderSettings& settings,
                                   const Target& target) {
  const auto start = Clock::now();
  check_settings(impl_->device, settings);
  if (settings.recipe.filter == Filter::rays)
    throw std::invalid_argument("filter rays: cannot be recorded, for the CPU casts them; use Renderer::draw()");
  FrameSlot& frame_slot = impl_->slots.at(slot);
  if (impl_->has_planned(settings))
    impl_->planned.plan.select_ms = impl_->planned.plan.project_ms = 0.0;
  else
    impl_->plan(settings);
  const gpu::Commands commands(impl_->device, cmd);
  impl_->record(impl_->prepare(commands, frame_slot, settings));
  if (target.image) impl_->record_target(commands, target);
  frame_slot.record_ms = ms_since(start);
  return frame_slot.stats;
}

void Renderer::record_again(VkCommandBuffer cmd, const Target& target) {
  impl_->check_drawn();
  impl_->record_target({impl_->device, cmd}, target);
}

const FrameStats& Renderer::stats(uint32_t slot) {
  return impl_->read_stats(impl_->slots.at(slot));
}

FrameStats Renderer::draw(const RenderSettings& settings) {
  check_settings(impl_->device, settings);
  if (settings.recipe.filter == Filter::rays && !settings.visibility)
    throw std::invalid_argument("filter rays: nothing says what is visible (RenderSettings::visibility)");
  return impl_->draw(impl_->slots.front(), settings);
}

void Renderer::warm_up(const RenderSettings& settings) {
  RenderSettings tiny = settings;
  tiny.width = tiny.height = 32;
  tiny.recipe.face_size_px = 16;
  if (tiny.recipe.select == Select::error_driven) tiny.recipe.select = Select::per_light;  // not to look at 32 x 32
  draw(tiny);
  impl_->plan(settings);
  FrameSlot& slot = impl_->slots.front();
  make_room(impl_->device, settings, impl_->planned.plan, slot, impl_->resources);
  slot.reset();
}

bool Renderer::has_new_selection() const {
  const Planned& planned = impl_->planned;
  return planned.is_there && planned.stats.selection_is_provisional && impl_->surroundings.has_news();
}

Picture Renderer::read_back() {
  impl_->check_drawn();
  return read_picture(impl_->device, impl_->resources.targets);
}

VkImage Renderer::shown_image() const {
  return impl_->resources.targets.shown.handle;
}

}  // namespace chandelier
