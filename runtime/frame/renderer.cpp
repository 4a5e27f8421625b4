// SPDX-License-Identifier: Apache-2.0
#include "frame/renderer.h"

#include <algorithm>
#include <cstring>

#include "frame/clock.h"
#include "frame/ray_frame.h"

namespace chandelier {
namespace {

// What was decided for the settings of a frame. Recorded frames that ask for the same take it again.
struct Planned {
  RenderSettings settings;
  Version world_version = 0;
  FramePlan plan;
  FrameStats stats;
  bool is_there = false;
  bool is_placed = false;  // its maps have places, which stay unless maps are kept
};

void check_settings(const gpu::Device& device, const RenderSettings& settings) {
  if (const auto reason = refusal(settings.recipe)) throw std::invalid_argument(*reason);
  if (settings.width == 0 || settings.height == 0) throw std::invalid_argument("a picture needs a size");
  const uint32_t largest = device.limits.maxImageDimension2D;
  if (settings.samples != 1 && !can_draw_samples(device, settings.samples))
    throw gpu::Error(std::to_string(settings.samples) + " samples in a pixel: this device cannot draw them");
  if (settings.width > largest || settings.height > largest)
    throw gpu::Error("a picture of " + std::to_string(settings.width) + " x " + std::to_string(settings.height) +
                     " pixels is too large for this device (" + std::to_string(largest) + ")");
}

}  // namespace

struct Renderer::Impl {
  gpu::Device& device;
  const World& world;
  Surroundings surroundings;
  FrameRecorder recorder;
  std::vector<FrameSlot> slots;
  Planned planned;

  Impl(gpu::Device& on, const World& of, const RendererOptions& options)
      : device(on), world(of), surroundings(of), recorder(on, of, options) {
    for (uint32_t i = 0; i < std::max(1u, options.frames_in_flight); ++i) slots.emplace_back(on);
  }

  bool has_planned(const RenderSettings& settings) const;
  void plan(const RenderSettings& settings);
  void prepare(FrameSlot& slot, const RenderSettings& settings);
  FrameStats draw(FrameSlot& slot, const RenderSettings& settings);
  const FrameStats& read_stats(FrameSlot& slot);
  void check_drawn() const;
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
                  .views = most_views(recorder.scene.batch_instance_count, settings.most_caster_draws),
                  .visibility_bytes = device.limits.maxStorageBufferRange},
                 &surroundings);
  planned.stats = planned_stats(world, planned.plan, settings);
  planned.settings = settings;
  planned.world_version = world.version();
  planned.is_there = true;
}

// Makes room for the plan and places its maps. The frame that used the slot has finished.
void Renderer::Impl::prepare(FrameSlot& slot, const RenderSettings& settings) {
  slot.reset();
  recorder.make_room(settings, planned.plan, slot);
  slot.stats = planned.stats;
  const bool keeps = keeps_maps(settings, planned.plan);
  if (keeps || !planned.is_placed)
    recorder.undo_if_it_throws([&] { slot.stats.shadow_maps_kept = recorder.place_maps(keeps, planned.plan); });
  planned.is_placed = true;
  slot.stats.sample_bytes =
      recorder.resources.edges.size_bytes + sample_target_bytes(settings.width, settings.height, settings.samples);
  slot.groups = planned.plan.groups.size();
  slot.is_read = false;
}

FrameStats Renderer::Impl::draw(FrameSlot& slot, const RenderSettings& settings) {
  const auto start = Clock::now();
  plan(settings);
  prepare(slot, settings);
  if (planned.plan.recipe.filter == Filter::rays)
    draw_by_rays(recorder, slot, settings, planned.plan);
  else
    recorder.undo_if_it_throws([&] {
      gpu::run_once(device, [&](gpu::Commands cmd) { recorder.record({cmd, slot, settings, planned.plan}); });
    });
  FrameStats stats = read_stats(slot);
  stats.frame_ms = ms_since(start);
  slot.reset();
  return stats;
}

void Renderer::Impl::check_drawn() const {
  if (!recorder.resources.targets.is_drawn) throw std::logic_error("no frame has been drawn yet");
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
  impl_->prepare(frame_slot, settings);
  impl_->recorder.record({commands, frame_slot, settings, impl_->planned.plan});
  if (target.image) impl_->recorder.record_target(commands, target);
  frame_slot.record_ms = ms_since(start);
  return frame_slot.stats;
}

void Renderer::record_again(VkCommandBuffer cmd, const Target& target) {
  impl_->check_drawn();
  impl_->recorder.record_target({impl_->device, cmd}, target);
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
  impl_->recorder.make_room(settings, impl_->planned.plan, slot);
  slot.reset();
}

bool Renderer::has_new_selection() const {
  const Planned& planned = impl_->planned;
  return planned.is_there && planned.stats.selection_is_provisional && impl_->surroundings.has_news();
}

Picture Renderer::read_back() {
  impl_->check_drawn();
  return read_picture(impl_->device, impl_->recorder.resources.targets);
}

VkImage Renderer::shown_image() const {
  return impl_->recorder.resources.targets.shown.handle;
}

}  // namespace chandelier
