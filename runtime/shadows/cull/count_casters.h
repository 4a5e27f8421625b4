// SPDX-License-Identifier: Apache-2.0
// The cull stage's counters without a device: the arithmetic of cull_none.comp and cull_light_frustum.comp on the CPU.
#pragma once

#include <span>

#include "frame/recipe.h"
#include "frame_schema.h"
#include "world/world.h"

namespace chandelier {

/// As frame::CullCounters, of all views of a frame together.
struct CasterCounts {
  uint64_t draws = 0;
  uint64_t triangles = 0;
};
CasterCounts count_casters(Cull cull, std::span<const frame::ShadowView> views, const World& world);

}  // namespace chandelier
