// SPDX-License-Identifier: Apache-2.0
#include "scene/world_changes.h"

#include <volk.h>

#include <algorithm>

namespace chandelier {
namespace {

constexpr size_t most_update_bytes = 65536;  // of vkCmdUpdateBuffer

// Of records, those whose numbers are given; neighbours in one update.
template <typename Record>
void record_updates(gpu::Commands cmd, const gpu::Buffer& buffer, std::span<const Record> records,
                    std::vector<uint32_t> numbers) {
  std::sort(numbers.begin(), numbers.end());
  constexpr size_t most = most_update_bytes / sizeof(Record);
  for (size_t i = 0; i < numbers.size();) {
    size_t count = 1;
    while (count < most && i + count < numbers.size() && numbers[i + count] == numbers[i] + count) ++count;
    const auto run = records.subspan(numbers[i], count);
    cmd->vkCmdUpdateBuffer(cmd, buffer.handle, numbers[i] * sizeof(Record), run.size_bytes(), run.data());
    i += count;
  }
}

}  // namespace

void record_world_changes(gpu::Commands cmd, const World& world, GpuScene& scene) {
  const std::vector<InstanceId> moved = world.instances_changed_since(scene.instances_version);
  if (moved.empty()) return;
  std::vector<uint32_t> batch_instances;
  for (const InstanceId id : moved) {
    const auto of_instance = world.batches_of(id);
    batch_instances.insert(batch_instances.end(), of_instance.begin(), of_instance.end());
  }
  constexpr VkPipelineStageFlags2 readers =
      VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT | VK_PIPELINE_STAGE_2_VERTEX_SHADER_BIT;
  gpu::memory_barrier(cmd, readers, VK_ACCESS_2_NONE, VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT, VK_ACCESS_2_NONE);
  record_updates(cmd, scene.instances, world.instances(), moved);
  record_updates(cmd, scene.batch_instances, world.batch_instances(), std::move(batch_instances));
  gpu::memory_barrier(cmd, VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT, VK_ACCESS_2_TRANSFER_WRITE_BIT, readers,
                      VK_ACCESS_2_SHADER_STORAGE_READ_BIT);
  scene.instances_version = world.instances_version();
}

}  // namespace chandelier
