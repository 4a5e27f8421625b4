// SPDX-License-Identifier: Apache-2.0
// Lookup answer `tiles`: which lights reach which tile of the picture (tiles.comp).
#pragma once

#include "lookup/lookup.h"

namespace chandelier {

class LookupTiles {
 public:
  static constexpr bool has_pass = true;

  explicit LookupTiles(const gpu::Device& device);
  /// Keeps what is large enough, and retires what is not. Throws gpu::Error where the device cannot bind so much.
  void make_room(const gpu::Device& device, const LookupRoom& room, gpu::Retired& retired);
  /// Leaves its data ready for compute shaders.
  void record(gpu::Commands cmd, const LookupInput& input) const;
  LookupData data() const { return {&words_, tiles_x_, words_per_tile_}; }

 private:
  gpu::Pipeline pipeline_;
  gpu::Pipeline with_edges_;
  gpu::Owned<VkSampler> texel_sampler_;
  gpu::Buffer words_;  // frame TileWord: words_per_tile_ for each tile, rows of tiles from the top
  uint32_t tiles_x_ = 0;
  uint32_t tiles_y_ = 0;
  uint32_t words_per_tile_ = 0;
};

}  // namespace chandelier
