// SPDX-License-Identifier: Apache-2.0
// The cull stage: which batches go into which views. The camera's g-buffer is culled by the same code.
#pragma once

#include "frame_schema.h"
#include "gpu/pipelines.h"
#include "recipe_schema.h"
#include "scene/gpu_scene.h"

namespace chandelier {

class CullPipelines {
 public:
  explicit CullPipelines(std::vector<gpu::Pipeline> pipelines) : pipelines_(std::move(pipelines)) {}
  /// Throws std::invalid_argument where the answer is not known.
  const gpu::Pipeline& operator[](Cull answer) const;

 private:
  std::vector<gpu::Pipeline> pipelines_;  // by Cull
};
CullPipelines make_cull_pipelines(const gpu::Device& device);

/// Where a list lies, and which material it draws.
struct DrawList {
  uint32_t number;
  uint32_t first_batch_instance;
  uint32_t batch_instances;
  uint32_t material;
};
/// CasterDraws in lists, one list per draw call: what cull writes and the draw calls read.
struct DrawLists {
  gpu::Buffer draws;   // frame CasterDraw; list l starts at (its first batch instance) * view_count
  gpu::Buffer counts;  // one u32 per list
  uint64_t capacity = 0;
  std::vector<DrawList> by_material;  // for shading: one per material
  std::vector<DrawList>
      for_shadows;  // number 0 has everything opaque (it may be empty), each masked material one of its own
};
/// Room for `draws` CasterDraws of this scene. Throws gpu::Error where the device cannot bind so many.
DrawLists make_draw_lists(const gpu::Device& device, const GpuScene& scene, uint64_t draws);

struct CullInput {
  const gpu::Buffer& views;     // frame ShadowView
  const gpu::Buffer& counters;  // frame CullCounters, one per round
  uint32_t first_view;
  uint32_t view_count;
  uint32_t merged_runs;  // 1: by_material; max(1, opaque runs): for_shadows
  uint32_t round;
  bool keep_order = false;    // needs view_count 1
  bool casters_only = false;  // leaves out what throws no shadow
};
/// Records everything between earlier reads of `lists` and later indirect draws from them.
void record_cull(gpu::Commands cmd, const gpu::Device& device, const gpu::Pipeline& pipeline, const GpuScene& scene,
                 const CullInput& input, const DrawLists& lists);

/// One multi-draw-indirect over a list that was culled with keep_order.
void draw_ordered_list(gpu::Commands cmd, const DrawLists& lists, const DrawList& list);
/// The same over a list that was culled for `view_count` views without it.
void draw_list(gpu::Commands cmd, const DrawLists& lists, const DrawList& list, uint32_t view_count);

}  // namespace chandelier
