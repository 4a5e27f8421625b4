// SPDX-License-Identifier: Apache-2.0
// Deliver answer `textures`: fills the visibility textures of a group's maps (visibility.comp).
#pragma once

#include "gpu/frames.h"
#include "shading/group_pass.h"

namespace chandelier {

/// The bytes of the visibility textures of one group at a time.
struct VisibilityTextures {
  gpu::Buffer bytes;
};
/// What a frame needs of it.
struct VisibilityRoom {
  uint64_t bytes;
  bool by_rays;  // the CPU writes them
  uint32_t width, height;
};
/// Keeps what is large enough, and retires what it replaces. Throws gpu::Error where the device cannot bind so much.
void make_room(const gpu::Device& device, const VisibilityRoom& room, gpu::Retired& retired,
               VisibilityTextures& textures);

/// Filters the group's maps into `input.visibility`, which shading may read afterwards.
void record_visibility(gpu::Commands cmd, const gpu::Device& device, GroupPipelines& pipelines, const Recipe& recipe,
                       const GroupInput& input, const CubeArray& store, const Targets& targets);

}  // namespace chandelier
