// SPDX-License-Identifier: Apache-2.0
// Brings a scene in GPU memory up to date with a world.
#pragma once

#include "scene/gpu_scene.h"
#include "world/world.h"

namespace chandelier {

/// Writes the transforms and boxes of instances that have moved since `scene` was uploaded or last brought up to date.
/// Records the barriers between what read them before and what reads them after. The data goes into the command buffer,
/// so the world may change again once this returns. Records nothing where nothing moved.
void record_world_changes(gpu::Commands cmd, const World& world, GpuScene& scene);

}  // namespace chandelier
