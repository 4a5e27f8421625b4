// SPDX-License-Identifier: Apache-2.0
// Budgets: the recipe that keeps one, and the lights that lose their own shadow map by it.
#pragma once

#include "player/camera.h"
#include "player/options.h"

namespace chandelier::player {

/// The lights of a list that take another one's shadow map, or shares of several (the largest's is named), in
/// the list's order.
std::vector<SharedMap> shared_maps(const pack::File& pack, const LightList& list);

/// Where a budget is given, gives each recipe with light clusters the d_init that keeps it, and tells error-driven
/// selection the budget; says on stderr what that means for the camera at the start.
void apply_budget(Options& options, const NamedCamera& camera, const pack::File& pack);

}  // namespace chandelier::player
