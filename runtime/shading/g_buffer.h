// SPDX-License-Identifier: Apache-2.0
// The g-buffer stage: what the camera sees, one multi-draw-indirect per material.
#pragma once

#include "shading/targets.h"
#include "shadows/cull/cull.h"

namespace chandelier {

/// Of pixels with so many samples.
gpu::Pipeline make_g_buffer_pipeline(const gpu::Device& device, const GpuScene& scene, uint32_t samples);

/// Draws what was culled for the camera, in order, into surface, depth and radiance; leaves the first two ready to be
/// sampled and radiance as a storage image. Where the targets have several samples: into those of the samples, and
/// leaves all ready to be sampled.
void record_g_buffer(gpu::Commands cmd, const gpu::Pipeline& pipeline, const GpuScene& scene, const CullState& culled,
                     const gpu::Buffer& view, const Targets& targets);

}  // namespace chandelier
