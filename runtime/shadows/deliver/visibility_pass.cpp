// SPDX-License-Identifier: Apache-2.0
#include "shadows/deliver/visibility_pass.h"

#include <volk.h>

#include <algorithm>
#include <utility>

#include "shaders/visibility_comp.h"

namespace chandelier {

void make_room(const gpu::Device& device, const VisibilityRoom& room, gpu::Retired& retired,
               VisibilityTextures& textures) {
  const uint64_t most = device.limits.maxStorageBufferRange;
  if (room.bytes > most)
    throw gpu::Error("a picture of " + std::to_string(room.width) + " x " + std::to_string(room.height) +
                     " pixels is too large for visibility textures on this device; use deliver inline");
  gpu::Buffer& held = textures.bytes;
  if (held.handle && held.size_bytes >= room.bytes && room.by_rays == (held.mapped != nullptr)) return;
  const auto size = std::min<VkDeviceSize>(gpu::grown(room.bytes, held.size_bytes), most);
  const gpu::Memory where = room.by_rays ? gpu::Memory::upload : gpu::Memory::device;
  retired.add(std::exchange(held, gpu::make_buffer(device, size, VK_BUFFER_USAGE_STORAGE_BUFFER_BIT, where)));
}

void record_visibility(gpu::Commands cmd, const gpu::Device& device, GroupPipelines& pipelines, const Recipe& recipe,
                       const GroupInput& input, const CubeArray& store, const Targets& targets) {
  const gpu::Pipeline& pipeline = group_pipeline(device, pipelines, visibility_comp, recipe, input);
  gpu::memory_barrier(cmd, VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT, VK_ACCESS_2_NONE,
                      VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT, VK_ACCESS_2_NONE);
  gpu::bind(cmd, pipeline, group_resources(pipelines, input, input.visibility, store, targets));
  gpu::push_constants(cmd, pipeline, group_constants(input));
  gpu::dispatch_over(cmd, pipeline, targets.width, targets.height);
  gpu::memory_barrier(cmd, VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT, VK_ACCESS_2_SHADER_STORAGE_WRITE_BIT,
                      VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT, VK_ACCESS_2_SHADER_STORAGE_READ_BIT);
}

}  // namespace chandelier
