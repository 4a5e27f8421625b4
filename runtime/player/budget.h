// SPDX-License-Identifier: Apache-2.0
// Budgets: the recipe that keeps one, and the lights that lose their own shadow map by it.
#pragma once

#include "player/camera.h"
#include "player/options.h"

namespace chandelier::player {

/// The lights of a list that take another one's shadow map, or shares of several (the largest's is named), in
/// the list's order.
std::vector<SharedMap> shared_maps(const pack::File& pack, const World& world, const LightList& list);

/// Where a budget is given, gives a recipe with light clusters the d_init that keeps it, and tells error-driven
/// selection the budget; says on stderr what that means for the view of `settings`, which get the recipe too.
void apply_budget(const Budget& budget, NamedRecipe& named, RenderSettings& settings, Predictor& predictor,
                  const pack::File& pack, const World& world);

/// The same for all recipes and the camera at the start. Not for a comparison, whose second side is exposed as the
/// first was drawn.
void apply_budget(Options& options, const NamedCamera& camera, const pack::File& pack, const World& world);

}  // namespace chandelier::player
