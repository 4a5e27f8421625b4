// SPDX-License-Identifier: Apache-2.0
// The cull stage's counters without a device: cull_ANSWER.h does on the CPU what cull_ANSWER.comp does.
#pragma once

#include <span>

#include "frame_schema.h"
#include "recipe_schema.h"
#include "world/world.h"

namespace chandelier {

/// As frame::CullCounters, of all views of a frame together.
struct CasterCounts {
  uint64_t draws = 0;
  uint64_t triangles = 0;
};
/// Throws std::invalid_argument where the answer is not known.
CasterCounts count_casters(Cull cull, std::span<const frame::ShadowView> views, const World& world);

}  // namespace chandelier
