// SPDX-License-Identifier: Apache-2.0
#include "lookup/lookup_tiles.h"

#include <volk.h>

#include <algorithm>
#include <utility>

#include "shaders/tiles_comp.h"

namespace chandelier {

LookupTiles::LookupTiles(const gpu::Device& device)
    : pipeline_(gpu::make_compute_pipeline(device, tiles_comp, {{"has_edges", 0}})),
      with_edges_(gpu::make_compute_pipeline(device, tiles_comp, {{"has_edges", 1}})),
      texel_sampler_(gpu::make_texel_sampler(device)) {}

void LookupTiles::make_room(const gpu::Device& device, const LookupRoom& room, gpu::Retired& retired) {
  tiles_x_ = (room.width + frame::tile_size_px - 1) / frame::tile_size_px;
  tiles_y_ = (room.height + frame::tile_size_px - 1) / frame::tile_size_px;
  words_per_tile_ = static_cast<uint32_t>(std::max<size_t>(1, (room.lights + 31) / 32));
  const uint64_t bytes = uint64_t{tiles_x_} * tiles_y_ * words_per_tile_ * sizeof(frame::TileWord);
  if (bytes > device.limits.maxStorageBufferRange)
    throw gpu::Error("too many lights in view for lookup tiles on this device (" + std::to_string(room.lights) +
                     "); use lookup all or a smaller picture");
  if (words_.size_bytes >= bytes) return;
  const auto size = std::min<VkDeviceSize>(gpu::grown(bytes, words_.size_bytes), device.limits.maxStorageBufferRange);
  gpu::Buffer words = gpu::make_buffer(device, size, VK_BUFFER_USAGE_STORAGE_BUFFER_BIT, gpu::Memory::device);
  retired.add(std::exchange(words_, std::move(words)));
}

void LookupTiles::record(gpu::Commands cmd, const LookupInput& input) const {
  const gpu::Pipeline& pipeline = input.edge_tiles ? with_edges_ : pipeline_;
  gpu::bind(cmd, pipeline,
            {{"View", gpu::storage(input.view)},
             {"Lights", gpu::storage(input.lights)},
             {"depth_image", gpu::sampled(input.targets.depth.view, texel_sampler_)},
             {"TileWords", gpu::storage(words_)},
             // Has to be something, read or not.
             {"EdgeTiles", gpu::storage(input.edge_tiles ? *input.edge_tiles : input.lights)}});
  gpu::push_constants(
      cmd, pipeline,
      frame::TileConstants{.light_count = static_cast<uint32_t>(input.light_count), .words_per_tile = words_per_tile_});
  cmd->vkCmdDispatch(cmd, tiles_x_, tiles_y_, 1);
  gpu::memory_barrier(cmd, VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT, VK_ACCESS_2_SHADER_STORAGE_WRITE_BIT,
                      VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT, VK_ACCESS_2_SHADER_STORAGE_READ_BIT);
}

}  // namespace chandelier
