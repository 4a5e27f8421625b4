// SPDX-License-Identifier: Apache-2.0
// Rasterize answer `multi-draw`: the casters of all views of a group in one pass, one multi-draw-indirect for
// everything opaque and one per alpha-tested material.
#pragma once

#include <span>

#include "shadows/cull/cull.h"
#include "shadows/store/cube_array.h"

namespace chandelier {

struct CasterPipelines {
  gpu::Pipeline opaque, masked;                // for views that have whole layers
  gpu::Pipeline opaque_placed, masked_placed;  // for views that have squares of layers
};
CasterPipelines make_caster_pipelines(const gpu::Device& device, const GpuScene& scene);

struct CasterInput {
  const CullState& culled;
  const gpu::Buffer& views;                // frame ShadowView
  const CubeArray& store;                  // in which `maps` lie
  std::span<const frame::ShadowMap> maps;  // of the group
  uint32_t cube_count;                     // that they take; the first ones where nothing is kept
  bool keeps;                              // what else lies in the store has to stay
};
/// Between these two, passes are drawn into the store; the second leaves it ready to be sampled.
void begin_casters(gpu::Commands cmd, const CasterInput& input);
void end_casters(gpu::Commands cmd, const CasterInput& input);
/// Draws what was culled for this pass. The first pass clears the maps that are not kept.
void record_casters(gpu::Commands cmd, const CasterPipelines& pipelines, const GpuScene& scene,
                    const CasterInput& input, uint32_t pass);

}  // namespace chandelier
