// SPDX-License-Identifier: Apache-2.0
// What the lookup stage's answers take and give. LookupANSWER in lookup_ANSWER.h has what the answer keeps from frame
// to frame, `has_pass`, make_room(), record() and data().
#pragma once

#include "frame_schema.h"
#include "gpu/frames.h"
#include "gpu/pipelines.h"
#include "shading/targets.h"

namespace chandelier {

struct LookupRoom {
  uint32_t width;
  uint32_t height;
  size_t lights;
};

struct LookupInput {
  const gpu::Buffer& view;    // frame ViewConstants
  const gpu::Buffer& lights;  // frame FrameLight
  size_t light_count;
  const Targets& targets;         // depth is ready to be sampled
  const gpu::Buffer* edge_tiles;  // frame EdgeTile for each tile, where pixels have several samples; else null
};

/// What shading reads.
struct LookupData {
  const gpu::Buffer* words = nullptr;  // frame TileWord; null: none
  uint32_t tiles_x = 0;
  uint32_t words_per_tile = 0;
};

}  // namespace chandelier
