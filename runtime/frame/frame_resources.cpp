// SPDX-License-Identifier: Apache-2.0
#include "frame/frame_resources.h"

#include <algorithm>

#include "shading/tone_map.h"

namespace chandelier {
namespace {

// The most of anything that a group of the frame needs.
struct Needs {
  uint32_t cubes = 1;
  uint32_t maps = 1;
  uint32_t views = 1;
  uint64_t visibility_bytes = 0;
};

Needs needs_of(const FramePlan& plan) {
  Needs needs;
  for (const MapGroup& group : plan.groups) {
    if (plan.recipe.filter != Filter::rays) {
      needs.cubes = std::max(needs.cubes, group.cube_count);
      needs.maps = std::max(needs.maps, group.map_count);
    }
    needs.views = std::max(needs.views, group.view_count);
    needs.visibility_bytes = std::max(needs.visibility_bytes, group.visibility_bytes);
  }
  return needs;
}

void make_counters(const gpu::Device& device, size_t groups, FrameSlot& slot, gpu::Buffer& counters) {
  const VkDeviceSize bytes = (groups + 1) * sizeof(frame::CullCounters);
  constexpr VkBufferUsageFlags usage =
      VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT | VK_BUFFER_USAGE_TRANSFER_SRC_BIT;
  if (!counters.handle || counters.size_bytes < bytes) {
    gpu::Buffer made = gpu::make_buffer(device, gpu::grown(bytes, counters.size_bytes), usage, gpu::Memory::device);
    slot.retired.add(std::exchange(counters, std::move(made)));
  }
  if (!slot.counters.handle || slot.counters.size_bytes < bytes)  // the slot's frame has finished
    slot.counters = gpu::make_buffer(device, gpu::grown(bytes, slot.counters.size_bytes),
                                     VK_BUFFER_USAGE_TRANSFER_DST_BIT, gpu::Memory::readback);
}

}  // namespace

FrameSlot::FrameSlot(const gpu::Device& device)
    : uploads(device),
      timers(device),
      exposure(gpu::make_buffer(device, sizeof(frame::LuminanceSum), VK_BUFFER_USAGE_TRANSFER_DST_BIT,
                                gpu::Memory::readback)),
      edges(gpu::make_buffer(device, sizeof(frame::EdgeCounters), VK_BUFFER_USAGE_TRANSFER_DST_BIT,
                             gpu::Memory::readback)) {}

void FrameSlot::reset() {
  uploads.reset();
  retired.clear();
}

size_t light_count(const FramePlan& plan) {
  return plan.list.lights.size() + plan.list.shadowless.size();
}

void make_room(const gpu::Device& device, const RenderSettings& settings, const FramePlan& plan, FrameSlot& slot,
               FrameResources& resources) {
  Targets& targets = resources.targets;
  if (targets.width != settings.width || targets.height != settings.height || targets.samples != settings.samples) {
    EdgeLists edges = make_edge_lists(device, settings.width, settings.height, settings.samples);
    Targets made = make_targets(device, settings.width, settings.height, settings.samples);
    gpu::Buffer sums = make_luminance_sums(device, settings.width, settings.height);
    slot.retired.add(std::exchange(targets, std::move(made)));
    slot.retired.add(std::exchange(resources.edges, std::move(edges)));
    slot.retired.add(std::exchange(resources.luminance_sums, std::move(sums)));
  }
  const Needs needs = needs_of(plan);
  make_room(device, {needs.visibility_bytes, plan.recipe.filter == Filter::rays, settings.width, settings.height},
            slot.retired, resources.visibility);
  make_room(device, settings.recipe, needs.cubes, slot.retired, resources.store);
  make_room(device, {.most_draws = UINT32_MAX, .one_pass = true}, slot.retired, resources.camera_draws);
  make_room(device, {.maps = needs.maps, .views = needs.views, .most_draws = settings.most_caster_draws}, slot.retired,
            resources.shadow_draws);
  make_counters(device, plan.groups.size(), slot, resources.counters);
}

}  // namespace chandelier
