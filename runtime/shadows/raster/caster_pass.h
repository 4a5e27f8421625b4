// SPDX-License-Identifier: Apache-2.0
// Rasterize answer `multi-draw`: the casters of all views of a round in one pass, one multi-draw-indirect for
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

/// Clears the first `cubes` cubes of the store and draws into them; leaves the store ready to be sampled.
void record_casters(gpu::Commands cmd, const CasterPipelines& pipelines, const GpuScene& scene, const DrawLists& lists,
                    const gpu::Buffer& views, uint32_t view_count, const CubeArray& store, uint32_t cubes);

}  // namespace chandelier
