// SPDX-License-Identifier: Apache-2.0
#include "player/truth.h"

#include <algorithm>

#ifdef CHANDELIER_EMBREE
#include "truth/ray_traced.h"
#endif

namespace chandelier::player {

VisibilitySource visibility_for([[maybe_unused]] std::span<const NamedRecipe> recipes,
                                [[maybe_unused]] const World& world) {
#ifdef CHANDELIER_EMBREE
  if (std::any_of(recipes.begin(), recipes.end(), traces_rays)) return truth::ray_traced_visibility(world);
#endif
  return {};
}

}  // namespace chandelier::player
