// SPDX-License-Identifier: Apache-2.0
// The pack's images, one descriptor set of five textures per material, and how their coordinates are transformed.
#pragma once

#include "scene/gpu_scene.h"

namespace chandelier {

/// Two rows for each texture of each material, also where there is none, so that shaders need not ask.
std::vector<glm::vec3> uv_rows(const pack::View& pack);

/// Fills images, samplers and the material sets of `scene`. Throws gpu::Error, and pack::Error where an image cannot be
/// decoded.
void upload_textures(const gpu::Device& device, gpu::Uploader& uploader, const pack::View& pack, float anisotropy,
                     GpuScene& scene);

}  // namespace chandelier
