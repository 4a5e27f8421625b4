// SPDX-License-Identifier: Apache-2.0
// The screen-sized images of a frame.
#pragma once

#include "gpu/image_uses.h"

namespace chandelier {

/// What the g-buffer draws into where pixels have several samples.
struct SampleTargets {
  gpu::Image surface;
  gpu::Image depth;  // at the sample
  gpu::Image radiance;
  gpu::Image middle_depth;  // in the middle of the pixel, on the same triangle
};

struct Targets {
  gpu::Image surface;     // shading/surface.glsl
  gpu::Image depth;       // reversed: 0 is the background, and pixels whose samples show several surfaces
  gpu::Image radiance;    // linear; alpha: shading/occlusion.h
  gpu::Image shown;       // sRGB values
  bool is_drawn = false;  // holds a frame, or will when what was recorded has finished
  uint32_t width = 0;
  uint32_t height = 0;
  uint32_t samples = 1;
  SampleTargets of_samples;  // empty where there is one sample in a pixel
};

/// 1, 2, 4 or 8 samples in a pixel.
bool can_draw_samples(const gpu::Device& device, uint32_t samples);
Targets make_targets(const gpu::Device& device, uint32_t width, uint32_t height, uint32_t samples);
/// Bytes of SampleTargets.
uint64_t sample_target_bytes(uint32_t width, uint32_t height, uint32_t samples);

}  // namespace chandelier
