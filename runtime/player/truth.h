// SPDX-License-Identifier: Apache-2.0
// Filter `rays` in the player: answered by Embree, in builds that have it.
#pragma once

#include <span>

#include "player/options.h"
#include "world/world.h"

namespace chandelier::player {

/// What answers filter `rays` for this world, which must outlive it; empty where no recipe asks. parse_options()
/// refuses those that ask in a build without Embree. Throws std::runtime_error, one line.
VisibilitySource visibility_for(std::span<const NamedRecipe> recipes, const World& world);

}  // namespace chandelier::player
