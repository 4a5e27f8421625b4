// SPDX-License-Identifier: Apache-2.0
#include "lookup/tiles.h"

#include <volk.h>

#include <algorithm>
#include <utility>

#include "shaders/tiles_comp.h"

namespace chandelier {

TilePipeline make_tile_pipeline(const gpu::Device& device) {
  return {gpu::make_compute_pipeline(device, tiles_comp, {{"has_edges", 0}}),
          gpu::make_compute_pipeline(device, tiles_comp, {{"has_edges", 1}}), gpu::make_texel_sampler(device)};
}

void make_tile_lists(const gpu::Device& device, uint32_t width, uint32_t height, size_t lights, gpu::Retired& retired,
                     TileLists& lists) {
  lists.tiles_x = (width + frame::tile_size_px - 1) / frame::tile_size_px;
  lists.tiles_y = (height + frame::tile_size_px - 1) / frame::tile_size_px;
  lists.words_per_tile = static_cast<uint32_t>(std::max<size_t>(1, (lights + 31) / 32));
  const uint64_t bytes = uint64_t{lists.tiles_x} * lists.tiles_y * lists.words_per_tile * sizeof(frame::TileWord);
  if (bytes > device.limits.maxStorageBufferRange)
    throw gpu::Error("too many lights in view for lookup tiles on this device (" + std::to_string(lights) +
                     "); use lookup all or a smaller picture");
  if (lists.words.size_bytes >= bytes) return;
  const auto size =
      std::min<VkDeviceSize>(gpu::grown(bytes, lists.words.size_bytes), device.limits.maxStorageBufferRange);
  gpu::Buffer words = gpu::make_buffer(device, size, VK_BUFFER_USAGE_STORAGE_BUFFER_BIT, gpu::Memory::device);
  retired.add(std::exchange(lists.words, std::move(words)));
}

void record_tiles(gpu::Commands cmd, const TilePipeline& tiles, const gpu::Buffer& view, const gpu::Buffer& lights,
                  size_t light_count, const Targets& targets, const gpu::Buffer* edge_tiles, const TileLists& lists) {
  const gpu::Pipeline& pipeline = edge_tiles ? tiles.with_edges : tiles.pipeline;
  gpu::bind(cmd, pipeline,
            {{"View", gpu::storage(view)},
             {"Lights", gpu::storage(lights)},
             {"depth_image", gpu::sampled(targets.depth.view, tiles.texel_sampler)},
             {"TileWords", gpu::storage(lists.words)},
             {"EdgeTiles", gpu::storage(edge_tiles ? *edge_tiles : lights)}});  // has to be something, read or not
  gpu::push_constants(
      cmd, pipeline,
      frame::TileConstants{.light_count = static_cast<uint32_t>(light_count), .words_per_tile = lists.words_per_tile});
  cmd->vkCmdDispatch(cmd, lists.tiles_x, lists.tiles_y, 1);
  gpu::memory_barrier(cmd, VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT, VK_ACCESS_2_SHADER_STORAGE_WRITE_BIT,
                      VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT, VK_ACCESS_2_SHADER_STORAGE_READ_BIT);
}

}  // namespace chandelier
