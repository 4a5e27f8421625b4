// SPDX-License-Identifier: Apache-2.0
#include "shadows/cull/cull.h"

#include <volk.h>

#include <algorithm>

#include "stages/cull_shaders.h"

namespace chandelier {

namespace {

std::vector<DrawList> lists_by_material(const GpuScene& scene) {
  std::vector<DrawList> lists;
  for (const MaterialRun& run : scene.runs)
    lists.push_back({static_cast<uint32_t>(lists.size()), run.first, run.count, run.material});
  return lists;
}

std::vector<DrawList> lists_for_shadows(const GpuScene& scene) {
  const auto all = lists_by_material(scene);
  const uint32_t opaque =
      scene.opaque_runs < scene.runs.size() ? scene.runs[scene.opaque_runs].first : scene.batch_instance_count;
  std::vector<DrawList> lists{{0, 0, opaque, pack::none}};
  // Without an opaque run list 0 is the first masked one's number: number the masked ones as cull.glsl does.
  for (uint32_t run = scene.opaque_runs; run < all.size(); ++run) {
    lists.push_back(all[run]);
    lists.back().number = run + 1 - std::max(1u, scene.opaque_runs);
  }
  return lists;
}

}  // namespace

CullPipelines make_cull_pipelines(const gpu::Device& device) {
  std::vector<gpu::Pipeline> pipelines;
  for (const gpu::Shader* shader : cull_shaders) pipelines.push_back(gpu::make_compute_pipeline(device, *shader));
  return CullPipelines(std::move(pipelines));
}

const gpu::Pipeline& CullPipelines::operator[](Cull answer) const {
  if (static_cast<size_t>(answer) >= pipelines_.size()) refuse_answer(answer);
  return pipelines_[static_cast<size_t>(answer)];
}

DrawLists make_draw_lists(const gpu::Device& device, const GpuScene& scene, uint64_t draws) {
  static_assert(sizeof(frame::CasterDraw) == frame::caster_draw_stride);
  const uint64_t bytes = draws * sizeof(frame::CasterDraw);
  if (bytes > device.limits.maxStorageBufferRange)
    throw gpu::Error("the scene has too many batches for this device (" + std::to_string(scene.batch_instance_count) +
                     ")");
  constexpr VkBufferUsageFlags usage =
      VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_INDIRECT_BUFFER_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT;
  return {gpu::make_buffer(device, bytes, usage, gpu::Memory::device),
          gpu::make_buffer(device, 4 * (scene.runs.size() + 1), usage, gpu::Memory::device), draws,
          lists_by_material(scene), lists_for_shadows(scene)};
}

void record_cull(gpu::Commands cmd, const gpu::Device& device, const gpu::Pipeline& pipeline, const GpuScene& scene,
                 const CullInput& input, const DrawLists& lists) {
  gpu::memory_barrier(cmd, VK_PIPELINE_STAGE_2_DRAW_INDIRECT_BIT | VK_PIPELINE_STAGE_2_VERTEX_SHADER_BIT,
                      VK_ACCESS_2_NONE, VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT | VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT,
                      VK_ACCESS_2_NONE);
  cmd->vkCmdFillBuffer(cmd, lists.counts.handle, 0, VK_WHOLE_SIZE, 0);
  gpu::memory_barrier(cmd, VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT | VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT,
                      VK_ACCESS_2_TRANSFER_WRITE_BIT | VK_ACCESS_2_SHADER_STORAGE_WRITE_BIT,
                      VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT,
                      VK_ACCESS_2_SHADER_STORAGE_READ_BIT | VK_ACCESS_2_SHADER_STORAGE_WRITE_BIT);
  const frame::CullConstants constants{.batch_instance_count = scene.batch_instance_count,
                                       .first_view = input.first_view,
                                       .view_count = input.view_count,
                                       .merged_runs = input.merged_runs,
                                       .round = input.round,
                                       .keep_order = input.keep_order,
                                       .casters_only = input.casters_only};
  gpu::bind(cmd, pipeline,
            {{"Views", gpu::storage(input.views)},
             {"BatchInstances", gpu::storage(scene.batch_instances)},
             {"Batches", gpu::storage(scene.batches)},
             {"MaterialRuns", gpu::storage(scene.material_runs)},
             {"RunOfBatchInstance", gpu::storage(scene.run_of_batch_instance)},
             {"Draws", gpu::storage(lists.draws)},
             {"Counts", gpu::storage(lists.counts)},
             {"Counters", gpu::storage(input.counters)}});
  gpu::push_constants(cmd, pipeline, constants);
  gpu::dispatch(cmd, device, pipeline, uint64_t{scene.batch_instance_count} * input.view_count);
  gpu::memory_barrier(cmd, VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT, VK_ACCESS_2_SHADER_STORAGE_WRITE_BIT,
                      VK_PIPELINE_STAGE_2_DRAW_INDIRECT_BIT | VK_PIPELINE_STAGE_2_VERTEX_SHADER_BIT,
                      VK_ACCESS_2_INDIRECT_COMMAND_READ_BIT | VK_ACCESS_2_SHADER_STORAGE_READ_BIT);
}

void draw_ordered_list(gpu::Commands cmd, const DrawLists& lists, const DrawList& list) {
  cmd->vkCmdDrawIndexedIndirect(cmd, lists.draws.handle,
                                VkDeviceSize{list.first_batch_instance} * sizeof(frame::CasterDraw),
                                list.batch_instances, frame::caster_draw_stride);
}

void draw_list(gpu::Commands cmd, const DrawLists& lists, const DrawList& list, uint32_t view_count) {
  if (list.batch_instances == 0) return;
  cmd->vkCmdDrawIndexedIndirectCount(
      cmd, lists.draws.handle, VkDeviceSize{list.first_batch_instance} * view_count * sizeof(frame::CasterDraw),
      lists.counts.handle, list.number * 4, list.batch_instances * view_count, frame::caster_draw_stride);
}

}  // namespace chandelier
