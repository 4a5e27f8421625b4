// SPDX-License-Identifier: Apache-2.0
// Rasterize answer `multi-draw`: the casters of all views of a group in one pass, one multi-draw-indirect for
// everything opaque and one per alpha-tested material.
#pragma once

#include "shadows/cull/cull.h"
#include "shadows/store/cube_array.h"

namespace chandelier {

struct CasterPipelines {
  gpu::Pipeline opaque;
  gpu::Pipeline masked;
};
CasterPipelines make_caster_pipelines(const gpu::Device& device, const GpuScene& scene);

/// Between these two, passes are drawn into the first `cubes` cubes of the store; the second leaves it ready to be
/// sampled.
void begin_casters(gpu::Commands cmd, const CubeArray& store);
void end_casters(gpu::Commands cmd, const CubeArray& store);
/// Draws what `culled` has for this pass. The first pass clears the cubes.
void record_casters(gpu::Commands cmd, const CasterPipelines& pipelines, const GpuScene& scene, const CullState& culled,
                    const gpu::Buffer& views, const CubeArray& store, uint32_t cubes, uint32_t pass);

}  // namespace chandelier
