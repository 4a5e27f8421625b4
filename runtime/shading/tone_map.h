// SPDX-License-Identifier: Apache-2.0
// Exposure, tone map and sRGB: radiance to the picture that is shown.
#pragma once

#include <optional>

#include "gpu/pipelines.h"
#include "shading/targets.h"

namespace chandelier {

struct TonePipelines {
  gpu::Pipeline sum;
  gpu::Pipeline expose;
  gpu::Pipeline tone_map;
};
TonePipelines make_tone_pipelines(const gpu::Device& device);

/// frame LuminanceSum records: one per 16 x 16 pixels.
gpu::Buffer make_luminance_sums(const gpu::Device& device, uint32_t width, uint32_t height);

/// Leaves the exposure used in the first record of `sums`, and `shown` ready to be copied from.
void record_tone_map(gpu::Commands cmd, const TonePipelines& pipelines, std::optional<float> exposure_ev,
                     const gpu::Buffer& sums, const Targets& targets);

}  // namespace chandelier
