// SPDX-License-Identifier: Apache-2.0
// The lookup stage: which lights reach which tile of the picture (tiles.comp).
#pragma once

#include "frame_schema.h"
#include "gpu/frames.h"
#include "gpu/pipelines.h"
#include "shading/targets.h"

namespace chandelier {

struct TilePipeline {
  gpu::Pipeline pipeline;
  gpu::Pipeline with_edges;
  gpu::Owned<VkSampler> texel_sampler;
};
TilePipeline make_tile_pipeline(const gpu::Device& device);

struct TileLists {
  gpu::Buffer words;  // frame TileWord: words_per_tile for each tile, rows of tiles from the top
  uint32_t tiles_x = 0;
  uint32_t tiles_y = 0;
  uint32_t words_per_tile = 0;
};
/// Makes room for `lights`; keeps what is large enough, and retires what is not. Throws gpu::Error where the device
/// cannot bind so much.
void make_tile_lists(const gpu::Device& device, uint32_t width, uint32_t height, size_t lights, gpu::Retired& retired,
                     TileLists& lists);

/// Reads depth, which must be ready to be sampled; leaves `lists` ready for compute shaders. `edge_tiles`: frame
/// EdgeTile for each tile, where pixels have several samples; else null.
void record_tiles(gpu::Commands cmd, const TilePipeline& tiles, const gpu::Buffer& view, const gpu::Buffer& lights,
                  size_t light_count, const Targets& targets, const gpu::Buffer* edge_tiles, const TileLists& lists);

}  // namespace chandelier
