// SPDX-License-Identifier: Apache-2.0
// The pack's images, and one descriptor set of five textures per material.
#pragma once

#include "scene/gpu_scene.h"

namespace chandelier {

/// Fills images, samplers and the material sets of `scene`. Throws gpu::Error.
void upload_textures(const gpu::Device& device, const pack::View& pack, GpuScene& scene);

}  // namespace chandelier
