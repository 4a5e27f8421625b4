// SPDX-License-Identifier: Apache-2.0
// The cull stage: which batches go into which views. The camera's g-buffer is culled by the same code.
//
// Draws are appended against counters on the device into a buffer of bounded size, of which every draw list has a part.
// Those that do not fit are appended in a further pass, after what is in the buffer has been drawn. Nothing is read
// back: as many passes are recorded as the views could fill, and a pass that has nothing to draw dispatches no group
// and draws nothing.
#pragma once

#include "gpu/frames.h"
#include "gpu/pipelines.h"
#include "recipe_schema.h"
#include "scene/gpu_scene.h"
#include "shadows/cull/draw_lists.h"

namespace chandelier {

/// The dispatches for one answer, and for one way to order draws.
struct CullPipelines {
  gpu::Pipeline boxes, find, count, plan, append;
  bool keep_order;
};
/// `keep_order`: of one view, whose draws keep the order of their batch instances.
CullPipelines make_cull_pipelines(const gpu::Device& device, Cull answer, bool keep_order);

/// What one user of the stage keeps from frame to frame.
struct CullState {
  std::vector<DrawList> lists;
  std::vector<frame::DrawSlots> slots;  // per list
  uint32_t views = 0;                   // that `slots` are made for
  uint64_t most_draws = 0;
  uint32_t block_count = 0;
  gpu::Buffer order;          // u32: batch instances
  gpu::Buffer blocks;         // frame BatchBlock
  gpu::Buffer boxes;          // frame BlockBox
  gpu::Buffer device_slots;   // frame DrawSlots
  gpu::Buffer pairs;          // frame BlockPair, one for each block and map
  gpu::Buffer totals;         // u32: pairs; draws of each list; draws before each list
  gpu::Buffer draws;          // frame CasterDraw
  gpu::Buffer draw_counts;    // u32: of each list in pass 0, then in pass 1 ...
  gpu::Buffer append_groups;  // indirect dispatches, one per pass
};
/// To be used once `uploader` has finished.
CullState make_cull_state(const gpu::Device& device, gpu::Uploader& uploader, const DrawLists& lists);

/// What a frame culls at a time.
struct CullRoom {
  uint32_t maps = 1;
  uint32_t views = 1;
  uint64_t most_draws = most_caster_draws;
  bool one_pass = false;  // an error where the device cannot draw all at a time
};
/// Keeps what is large enough, and retires what it replaces. Throws gpu::Error where the device cannot bind so much.
void make_room(const gpu::Device& device, const CullRoom& room, gpu::Retired& retired, CullState& state);

struct CullInput {
  const gpu::Buffer& views;     // frame ShadowView
  const gpu::Buffer& maps;      // frame ShadowMap; unused where order is kept
  const gpu::Buffer& counters;  // frame CullCounters, one per group
  uint32_t first_map;           // where order is kept, the one view
  uint32_t map_count;
  uint32_t view_count;
  uint32_t group;
};
/// Boxes around the blocks, once per frame.
void record_boxes(gpu::Commands cmd, const gpu::Device& device, const CullPipelines& pipelines, const GpuScene& scene,
                  const CullInput& input, const CullState& state);
/// Finds what each view draws, and writes the draws of the first pass: everything between earlier reads of `state` and
/// later indirect draws from it. Returns how many passes there may be.
uint32_t record_cull(gpu::Commands cmd, const gpu::Device& device, const CullPipelines& pipelines,
                     const GpuScene& scene, const CullInput& input, const CullState& state);
/// Writes the draws of a further pass in their place.
void record_append(gpu::Commands cmd, const CullPipelines& pipelines, const GpuScene& scene, const CullInput& input,
                   const CullState& state, uint32_t pass);

/// One indirect multi-draw over the draws that a list has in a pass.
void draw_list(gpu::Commands cmd, const CullState& state, size_t list, uint32_t pass);

}  // namespace chandelier
