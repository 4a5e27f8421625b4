// SPDX-License-Identifier: Apache-2.0
// The cull stage's counters without a device: cull_ANSWER.h does on the CPU what cull_ANSWER.comp does.
#pragma once

#include <span>

#include "frame_schema.h"
#include "recipe_schema.h"
#include "world/world.h"

namespace chandelier {

/// As frame::CullCounters, of all groups of maps together.
struct CasterCounts {
  uint64_t draws = 0;
  uint64_t triangles = 0;
  uint64_t further_passes = 0;
};
/// Views [first, first + count) are culled together.
struct ViewGroup {
  uint32_t first;
  uint32_t count;
};
/// Throws std::invalid_argument where the answer is not known.
CasterCounts count_casters(Cull cull, std::span<const frame::ShadowView> views, std::span<const ViewGroup> groups,
                           uint64_t most_draws, const World& world);

}  // namespace chandelier
