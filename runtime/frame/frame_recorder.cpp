// SPDX-License-Identifier: Apache-2.0
// A frame: its stages in order, barriers in sight.
#include "frame/frame_recorder.h"

#include <volk.h>

#include <algorithm>
#include <cmath>

#include "scene/world_changes.h"
#include "shading/g_buffer.h"
#include "shadows/deliver/visibility_textures.h"

namespace chandelier {
namespace {

constexpr float anisotropy_on_gpus = 8.0f;

// Mesa's software drivers take many times as long for an anisotropic fetch.
float anisotropy_on(const gpu::Device& device, const RendererOptions& options) {
  return options.anisotropy.value_or(device.is_software ? 1.0f : anisotropy_on_gpus);
}

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

}  // namespace

bool keeps_maps(const RenderSettings& settings, const FramePlan& plan) {
  return settings.keep_shadow_maps && plan.groups.size() == 1;
}

FrameRecorder::FrameRecorder(gpu::Device& on, const World& of, const RendererOptions& options)
    : device(on),
      world(of),
      scene(upload_scene(on, of, {anisotropy_on(on, options), options.upload_progress})),
      camera_cull(make_cull_pipelines(on, Cull::light_frustum, true)),
      casters(make_caster_pipelines(on, scene)),
      g_buffer(make_g_buffer_pipeline(on, scene, 1)),
      lookup(on),
      group_pipelines(on),
      tone(make_tone_pipelines(on)) {
  gpu::Uploader uploader(on, 0, {});
  resources.camera_draws = make_cull_state(on, uploader, lists_by_material(of.pack()));
  resources.shadow_draws = make_cull_state(on, uploader, lists_for_shadows(of.pack()));
  uploader.finish();
}

void FrameRecorder::make_room(const RenderSettings& settings, const FramePlan& plan, FrameSlot& slot) {
  chandelier::make_room(device, settings, plan, slot, resources);
  const LookupRoom room{settings.width, settings.height, light_count(plan)};
  lookup.with(plan.recipe.lookup, [&](auto& answer) { answer.make_room(device, room, slot.retired); });
}

uint64_t FrameRecorder::place_maps(bool keep, FramePlan& plan) {
  KeptMaps& maps = resources.store.maps;
  if (plan.recipe.filter == Filter::rays) return 0;
  for (const MapGroup& group : plan.groups) {
    if (!keep) maps.forget();
    maps.place(group, world, plan.recipe.cull, plan.list, plan.views);
  }
  return static_cast<uint64_t>(std::ranges::count(plan.list.maps, 1u, &frame::ShadowMap::is_kept));
}

void FrameRecorder::record_uploads(const Recording& frame) {
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
void FrameRecorder::record_device_plan(const Recording& frame) {
  const auto& [cmd, slot, settings, plan] = frame;
  const LookupInput input{.view = resources.view.buffer(),
                          .lights = resources.lights.buffer(),
                          .light_count = light_count(plan),
                          .targets = resources.targets,
                          .edge_tiles = settings.samples > 1 ? &resources.edges.tiles : nullptr};
  lookup.with(plan.recipe.lookup, [&]<typename Answer>(const Answer& answer) {
    if constexpr (Answer::has_pass) {
      const Timed timed(frame, "lookup");
      answer.record(frame.cmd, input);
    }
  });
}

const SamplePipelines& FrameRecorder::pipelines_of(uint32_t samples) {
  const auto found = of_samples.find(samples);
  if (found != of_samples.end()) return found->second;
  SamplePipelines made{make_g_buffer_pipeline(device, scene, samples), make_edge_pipelines(device, samples)};
  return of_samples.emplace(samples, std::move(made)).first->second;
}

Edges FrameRecorder::edges(const Recording& frame) {
  const RenderSettings& settings = frame.settings;
  const float pixel_angle = 2.0f * std::tan(0.5f * settings.camera.yfov_rad) / static_cast<float>(settings.height);
  return {pipelines_of(settings.samples).edges, resources.edges, resources.targets, pixel_angle};
}

// What the camera sees, and which lights reach it.
void FrameRecorder::record_start(const Recording& frame) {
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
void FrameRecorder::record_shadow_maps(const Recording& frame, uint32_t number) {
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
                          .keeps = keeps_maps(settings, plan)};
  begin_casters(cmd, drawn);
  for (uint32_t pass = 0; pass < passes; ++pass) {
    if (pass > 0) record_append(cmd, culling, scene, input, culled, pass);
    record_casters(cmd, casters, scene, drawn, pass);
  }
  end_casters(cmd, drawn);
}

GroupInput FrameRecorder::group_input(const FramePlan& plan, const MapGroup& group, const gpu::Buffer& visibility) {
  return {.view = resources.view.buffer(),
          .lights = resources.lights.buffer(),
          .maps = resources.maps.buffer(),
          .views = resources.views.buffer(),
          .visibility = visibility,
          .lookup = lookup.with(plan.recipe.lookup, [](const auto& answer) { return answer.data(); }),
          .first_light = group.first_light,
          .light_count = group.light_count + group.shadowless_count,
          .projections = projections_of(plan.list.maps),
          .parts_of_layers = has_parts_of_layers(plan.list.maps, resources.store)};
}

// Adds the light of a group's lights. Where visibility comes from rays it is in `visibility` already; that of edges
// follows.
void FrameRecorder::record_light(const Recording& frame, const MapGroup& group) {
  const auto& [cmd, slot, settings, plan] = frame;
  GroupInput input = group_input(plan, group, resources.visibility.bytes);
  if (has_textures(plan.recipe.deliver) && plan.recipe.filter != Filter::rays) {
    const Timed timed(frame, "deliver");
    input.light_count = group.light_count;
    record_visibility(cmd, device, group_pipelines, plan.recipe, input, resources.store, resources.targets);
  }
  input.light_count = group.light_count + group.shadowless_count;
  const Timed timed(frame, "shade");
  record_shade(cmd, device, group_pipelines, plan.recipe, input, resources.store, resources.targets);
  if (settings.samples > 1 && plan.recipe.filter != Filter::rays)
    record_shade_edges(cmd, device, group_pipelines, plan.recipe, input, resources.store, edges(frame));
}

// The picture as shown, and the counters.
void FrameRecorder::record_end(const Recording& frame) {
  const auto& [cmd, slot, settings, plan] = frame;
  {
    const Timed timed(frame, "tone-map");
    const bool has_samples = settings.samples > 1;
    if (has_samples) record_resolve(cmd, edges(frame));
    record_tone_map(cmd, tone, settings.exposure_ev, resources.luminance_sums, resources.targets);
    if (has_samples) record_resolve_shown(cmd, edges(frame), resources.luminance_sums);
  }
  resources.targets.is_drawn = true;
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

void FrameRecorder::record(const Recording& frame) {
  const FramePlan& plan = frame.plan;
  undo_if_it_throws([&] {
    record_start(frame);
    for (uint32_t group = 0; group < plan.groups.size(); ++group) {
      if (plan.groups[group].map_count > 0) record_shadow_maps(frame, group);
      record_light(frame, plan.groups[group]);
    }
    record_end(frame);
  });
}

void FrameRecorder::record_target(gpu::Commands cmd, const Target& target) const {
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

}  // namespace chandelier
