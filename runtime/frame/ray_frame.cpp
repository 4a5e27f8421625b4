// SPDX-License-Identifier: Apache-2.0
#include "frame/ray_frame.h"

#include <algorithm>

#include "frame/clock.h"
#include "shadows/filter/ray_visibility.h"

namespace chandelier {
namespace {

constexpr uint64_t most_edge_visibility_bytes = uint64_t{64} << 20;  // held at a time

std::span<uint8_t> bytes_of(const gpu::Buffer& visibility) {
  return {reinterpret_cast<uint8_t*>(visibility.mapped), visibility.size_bytes};
}

AskedLights asked_of(const FramePlan& plan) {
  return {plan.list, plan.recipe.z_far_m, plan.view.eye_ws};
}

// In parts whose visibility fits a buffer.
void light_edges(FrameRecorder& recorder, const Recording& frame, const MapGroup& group,
                 std::span<const SurfacePoint> points) {
  if (points.empty()) return;
  const auto& [none, slot, settings, plan] = frame;
  const uint64_t maps = std::max<uint64_t>(group.map_count, 1);
  const uint64_t most = std::clamp<uint64_t>(most_edge_visibility_bytes / maps, 1, points.size());
  const gpu::Buffer visibility =
      gpu::make_buffer(recorder.device, most * maps, VK_BUFFER_USAGE_STORAGE_BUFFER_BIT, gpu::Memory::upload);
  for (size_t first = 0; first < points.size(); first += most) {
    const auto part = points.subspan(first, std::min<size_t>(most, points.size() - first));
    const auto start = Clock::now();
    fill_edge_visibility(asked_of(plan), group, part, settings.visibility, bytes_of(visibility));
    slot.timers.add_cpu("filter", ms_since(start));
    const GroupInput input = recorder.group_input(plan, group, visibility);
    gpu::run_once(recorder.device, [&](gpu::Commands cmd) {
      record_shade_edges(cmd, recorder.device, recorder.group_pipelines, plan.recipe, input, recorder.resources.store,
                         recorder.edges(frame), {static_cast<uint32_t>(first), static_cast<uint32_t>(part.size())});
    });
  }
}

// First what the camera sees, then each group's light.
void draw(FrameRecorder& recorder, FrameSlot& slot, const RenderSettings& settings, const FramePlan& plan) {
  gpu::Device& device = recorder.device;
  const FrameResources& resources = recorder.resources;
  const Recording unrecorded{{device, VK_NULL_HANDLE}, slot, settings, plan};
  const auto run = [&](const auto& record) {
    gpu::run_once(device, [&](gpu::Commands cmd) { record(Recording{cmd, slot, settings, plan}); });
  };
  const gpu::Buffer readback = make_surface_readback(device, settings.width, settings.height);
  run([&](const Recording& frame) {
    recorder.record_start(frame);
    record_read_surfaces(frame.cmd, resources.targets, readback);
  });
  const auto points = surface_points(readback, plan.view);
  std::vector<SurfacePoint> edge_points;
  if (settings.samples > 1) edge_points = read_edge_points(device, recorder.edges(unrecorded), resources.view.buffer());
  for (const MapGroup& group : plan.groups) {
    const auto start = Clock::now();
    fill_visibility(asked_of(plan), group, points, settings.width, settings.visibility,
                    bytes_of(resources.visibility.bytes));
    slot.timers.add_cpu("filter", ms_since(start));
    run([&](const Recording& frame) { recorder.record_light(frame, group); });
    light_edges(recorder, unrecorded, group, edge_points);
  }
  run([&](const Recording& frame) { recorder.record_end(frame); });
}

}  // namespace

void draw_by_rays(FrameRecorder& recorder, FrameSlot& slot, const RenderSettings& settings, const FramePlan& plan) {
  recorder.undo_if_it_throws([&] { draw(recorder, slot, settings, plan); });
}

}  // namespace chandelier
