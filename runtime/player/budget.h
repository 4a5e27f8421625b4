// SPDX-License-Identifier: Apache-2.0
// Budgets: the recipe that meets one, and the lights that lose their own shadow map because of it.
#pragma once

#include "player/camera.h"
#include "player/options.h"

namespace chandelier::player {

/// The lights of a list that take another one's shadow map, or shares of several (the largest's is named), in
/// the list's order.
std::vector<SharedMap> shared_maps(const pack::File& pack, const World& world, const LightList& list);

/// If there is a budget: chooses the d_init of a recipe with light clusters, or passes the budget to error-driven
/// selection. Prints on stderr what that means for the view of `settings`, and stores the recipe there too.
void apply_budget(const Budget& budget, NamedRecipe& named, RenderSettings& settings, Predictor& predictor,
                  const pack::File& pack, const World& world);

/// The same for all recipes and the first camera. Not for a comparison: its second side takes the exposure of the
/// first.
void apply_budget(Options& options, const NamedCamera& camera, const pack::File& pack, const World& world);

}  // namespace chandelier::player
