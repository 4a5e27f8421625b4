// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "shading/targets.h"

namespace chandelier {

/// Rows from the top, four channels.
struct Picture {
  uint32_t width = 0;
  uint32_t height = 0;
  std::vector<float> radiance;  // linear, before exposure and tone map; alpha: shading/occlusion.h
  std::vector<uint8_t> shown;   // sRGB RGBA, as on a screen
};

/// Of a frame that was drawn: radiance in use::storage, shown in TRANSFER_SRC_OPTIMAL; both stay so.
Picture read_picture(const gpu::Device& device, const Targets& targets);

}  // namespace chandelier
