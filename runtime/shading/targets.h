// SPDX-License-Identifier: Apache-2.0
// The screen-sized images of a frame.
#pragma once

#include "gpu/image_uses.h"

namespace chandelier {

struct Targets {
  gpu::Image surface;   // shading/surface.glsl
  gpu::Image depth;     // reversed: 0 is the background
  gpu::Image radiance;  // linear; alpha: shading/occlusion.h
  gpu::Image shown;     // sRGB values
  uint32_t width = 0;
  uint32_t height = 0;
};

Targets make_targets(const gpu::Device& device, uint32_t width, uint32_t height);

}  // namespace chandelier
