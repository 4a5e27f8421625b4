// SPDX-License-Identifier: Apache-2.0
#include "shadows/cull/cull.h"

#include <volk.h>

#include <algorithm>
#include <utility>

#include "shaders/block_boxes_comp.h"
#include "shaders/plan_draws_comp.h"
#include "stages/cull_shaders.h"

namespace chandelier {
namespace {

// What a dispatch of an answer's shader does (cull.glsl).
enum class Step : uint32_t { find, count, append };

constexpr VkBufferUsageFlags storage_use = VK_BUFFER_USAGE_STORAGE_BUFFER_BIT;
constexpr VkBufferUsageFlags indirect_use = storage_use | VK_BUFFER_USAGE_INDIRECT_BUFFER_BIT;

void grow(const gpu::Device& device, uint64_t bytes, VkBufferUsageFlags usage, gpu::Retired& retired,
          gpu::Buffer& buffer) {
  if (buffer.handle && buffer.size_bytes >= bytes) return;
  const uint64_t most = device.limits.maxStorageBufferRange;
  if (bytes > most) throw gpu::Error("the scene has too many batches for this device");
  const uint64_t size = std::min<uint64_t>(gpu::grown(bytes, buffer.size_bytes), most);
  retired.add(std::exchange(buffer, gpu::make_buffer(device, size, usage, gpu::Memory::device)));
}

// Written once; frames on their way may still read the one before.
gpu::Buffer mapped_copy(const gpu::Device& device, const std::vector<frame::DrawSlots>& slots) {
  const auto bytes = std::as_bytes(std::span(slots));
  gpu::Buffer buffer = gpu::make_buffer(device, bytes.size(), storage_use, gpu::Memory::upload);
  std::ranges::copy(bytes, buffer.mapped);
  return buffer;
}

uint64_t draws_within(const std::vector<frame::DrawSlots>& slots) {
  return slots.empty() ? 0 : uint64_t{slots.back().first} + slots.back().capacity;
}

void push(gpu::Commands cmd, const gpu::Pipeline& pipeline, const CullInput& input, const CullState& state,
          uint32_t pass) {
  gpu::push_constants(cmd, pipeline,
                      frame::CullConstants{.block_count = state.block_count,
                                           .list_count = static_cast<uint32_t>(state.lists.size()),
                                           .first_map = input.first_map,
                                           .map_count = input.map_count,
                                           .pass_count = passes_at_most(state.lists, state.slots, input.view_count),
                                           .draw_pass = pass,
                                           .group = input.group});
}

void bind_step(gpu::Commands cmd, const gpu::Pipeline& pipeline, const GpuScene& scene, const CullInput& input,
               const CullState& state, uint32_t pass) {
  gpu::bind(cmd, pipeline,
            {{"Views", gpu::storage(input.views)},
             {"Maps", gpu::storage(input.maps)},
             {"BatchInstances", gpu::storage(scene.batch_instances)},
             {"Batches", gpu::storage(scene.batches)},
             {"Order", gpu::storage(state.order)},
             {"Blocks", gpu::storage(state.blocks)},
             {"Boxes", gpu::storage(state.boxes)},
             {"Slots", gpu::storage(state.device_slots)},
             {"Pairs", gpu::storage(state.pairs)},
             {"Totals", gpu::storage(state.totals)},
             {"Draws", gpu::storage(state.draws)},
             {"Counters", gpu::storage(input.counters)}});
  push(cmd, pipeline, input, state, pass);
}

void bind_plan(gpu::Commands cmd, const gpu::Pipeline& pipeline, const CullInput& input, const CullState& state) {
  gpu::bind(cmd, pipeline,
            {{"Blocks", gpu::storage(state.blocks)},
             {"Slots", gpu::storage(state.device_slots)},
             {"Pairs", gpu::storage(state.pairs)},
             {"Totals", gpu::storage(state.totals)},
             {"Counts", gpu::storage(state.draw_counts)},
             {"Appends", gpu::storage(state.append_groups)},
             {"Counters", gpu::storage(input.counters)}});
  push(cmd, pipeline, input, state, 0);
}

// What a dispatch wrote is read by the next, and by indirect commands.
void wait_for_dispatch(gpu::Commands cmd) {
  gpu::memory_barrier(cmd, VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT, VK_ACCESS_2_SHADER_STORAGE_WRITE_BIT,
                      VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT | VK_PIPELINE_STAGE_2_DRAW_INDIRECT_BIT |
                          VK_PIPELINE_STAGE_2_VERTEX_SHADER_BIT,
                      VK_ACCESS_2_SHADER_STORAGE_READ_BIT | VK_ACCESS_2_SHADER_STORAGE_WRITE_BIT |
                          VK_ACCESS_2_INDIRECT_COMMAND_READ_BIT);
}

}  // namespace

CullPipelines make_cull_pipelines(const gpu::Device& device, Cull answer, bool keep_order) {
  if (static_cast<size_t>(answer) >= cull_shaders.size()) refuse_answer(answer);
  const gpu::Shader& shader = *cull_shaders[static_cast<size_t>(answer)];
  const auto step = [&](Step number) {
    return gpu::make_compute_pipeline(device, shader,
                                      {{"cull_step", static_cast<uint32_t>(number)}, {"keep_order", keep_order}});
  };
  return {gpu::make_compute_pipeline(device, block_boxes_comp),
          step(Step::find),
          step(Step::count),
          gpu::make_compute_pipeline(device, plan_draws_comp, {{"keep_order", keep_order}}),
          step(Step::append),
          keep_order};
}

CullState make_cull_state(const gpu::Device& device, gpu::Uploader& uploader, const DrawLists& lists) {
  CullState state;
  state.lists = lists.lists;
  state.block_count = static_cast<uint32_t>(lists.blocks.size());
  state.order = uploader.buffer(std::as_bytes(std::span(lists.order)), storage_use);
  state.blocks = uploader.buffer(std::as_bytes(std::span(lists.blocks)), storage_use);
  state.boxes =
      gpu::make_buffer(device, lists.blocks.size() * sizeof(frame::BlockBox), storage_use, gpu::Memory::device);
  state.totals = gpu::make_buffer(device, 4 * (2 * lists.lists.size() + 1),
                                  storage_use | VK_BUFFER_USAGE_TRANSFER_DST_BIT, gpu::Memory::device);
  return state;
}

void make_room(const gpu::Device& device, const CullRoom& room, gpu::Retired& retired, CullState& state) {
  static_assert(sizeof(frame::CasterDraw) == frame::caster_draw_stride);
  const uint64_t bindable = device.limits.maxStorageBufferRange / sizeof(frame::CasterDraw);
  // More views than a frame has change nothing: a list's part is then as large as its share.
  if (room.views > state.views || room.most_draws != state.most_draws) {
    state.views = std::max(room.views, state.views + state.views / 2);
    state.most_draws = room.most_draws;
    state.slots = divide_draws(state.lists, state.views, std::min(room.most_draws, bindable - state.lists.size()),
                               device.limits.maxDrawIndirectCount);
    retired.add(std::exchange(state.device_slots, mapped_copy(device, state.slots)));
  }
  const uint64_t passes = passes_at_most(state.lists, state.slots, room.views);
  if (room.one_pass && passes > 1) throw gpu::Error("the scene has too many batches for this device");
  const uint64_t pairs = uint64_t{room.maps} * state.block_count;
  grow(device, draws_within(state.slots) * sizeof(frame::CasterDraw), indirect_use, retired, state.draws);
  grow(device, pairs * sizeof(frame::BlockPair), storage_use, retired, state.pairs);
  grow(device, passes * state.lists.size() * sizeof(uint32_t), indirect_use, retired, state.draw_counts);
  grow(device, passes * sizeof(VkDispatchIndirectCommand), indirect_use, retired, state.append_groups);
}

void record_boxes(gpu::Commands cmd, const gpu::Device& device, const CullPipelines& pipelines, const GpuScene& scene,
                  const CullInput& input, const CullState& state) {
  gpu::memory_barrier(cmd, VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT, VK_ACCESS_2_NONE,
                      VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT, VK_ACCESS_2_NONE);
  gpu::bind(cmd, pipelines.boxes,
            {{"BatchInstances", gpu::storage(scene.batch_instances)},
             {"Order", gpu::storage(state.order)},
             {"Blocks", gpu::storage(state.blocks)},
             {"Boxes", gpu::storage(state.boxes)}});
  push(cmd, pipelines.boxes, input, state, 0);
  gpu::dispatch(cmd, device, pipelines.boxes, state.block_count);
  wait_for_dispatch(cmd);
}

uint32_t record_cull(gpu::Commands cmd, const gpu::Device& device, const CullPipelines& pipelines,
                     const GpuScene& scene, const CullInput& input, const CullState& state) {
  gpu::memory_barrier(
      cmd,
      VK_PIPELINE_STAGE_2_DRAW_INDIRECT_BIT | VK_PIPELINE_STAGE_2_VERTEX_SHADER_BIT |
          VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT,
      VK_ACCESS_2_SHADER_STORAGE_WRITE_BIT,
      VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT | VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT,
      VK_ACCESS_2_TRANSFER_WRITE_BIT | VK_ACCESS_2_SHADER_STORAGE_READ_BIT | VK_ACCESS_2_SHADER_STORAGE_WRITE_BIT);
  cmd->vkCmdFillBuffer(cmd, state.totals.handle, 0, VK_WHOLE_SIZE, 0);
  gpu::memory_barrier(cmd, VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT, VK_ACCESS_2_TRANSFER_WRITE_BIT,
                      VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT,
                      VK_ACCESS_2_SHADER_STORAGE_READ_BIT | VK_ACCESS_2_SHADER_STORAGE_WRITE_BIT);
  const uint64_t most_pairs = uint64_t{state.block_count} * input.map_count;
  bind_step(cmd, pipelines.find, scene, input, state, 0);
  gpu::dispatch(cmd, device, pipelines.find, most_pairs);
  wait_for_dispatch(cmd);
  bind_step(cmd, pipelines.count, scene, input, state, 0);
  cmd->vkCmdDispatch(cmd, static_cast<uint32_t>(std::clamp<uint64_t>(most_pairs, 1, frame::cull_groups)), 1, 1);
  wait_for_dispatch(cmd);
  bind_plan(cmd, pipelines.plan, input, state);
  cmd->vkCmdDispatch(cmd, 1, 1, 1);
  wait_for_dispatch(cmd);
  if (pipelines.keep_order) record_append(cmd, pipelines, scene, input, state, 0);
  return passes_at_most(state.lists, state.slots, input.view_count);
}

void record_append(gpu::Commands cmd, const CullPipelines& pipelines, const GpuScene& scene, const CullInput& input,
                   const CullState& state, uint32_t pass) {
  gpu::memory_barrier(cmd, VK_PIPELINE_STAGE_2_DRAW_INDIRECT_BIT | VK_PIPELINE_STAGE_2_VERTEX_SHADER_BIT,
                      VK_ACCESS_2_NONE, VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT, VK_ACCESS_2_NONE);
  bind_step(cmd, pipelines.append, scene, input, state, pass);
  cmd->vkCmdDispatchIndirect(cmd, state.append_groups.handle, pass * sizeof(VkDispatchIndirectCommand));
  wait_for_dispatch(cmd);
}

void draw_list(gpu::Commands cmd, const CullState& state, size_t list, uint32_t pass) {
  const frame::DrawSlots& slots = state.slots[list];
  cmd->vkCmdDrawIndexedIndirectCount(
      cmd, state.draws.handle, VkDeviceSize{slots.first} * sizeof(frame::CasterDraw), state.draw_counts.handle,
      (VkDeviceSize{pass} * state.lists.size() + list) * sizeof(uint32_t), slots.capacity, frame::caster_draw_stride);
}

}  // namespace chandelier
