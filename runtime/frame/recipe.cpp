// SPDX-License-Identifier: Apache-2.0
#include "frame/recipe.h"

namespace chandelier {

std::optional<std::string> refusal(const Recipe& recipe) {
  if (auto reason = table_refusal(recipe)) return reason;
  const bool clustered = recipe.select == Select::light_clusters;
  if (clustered && recipe.filter == Filter::hard && recipe.d_init_m > 0.0f)
    return "select light-clusters with filter hard: lights that share a map need a soft filter (LightCluster §3.2.1); "
           "use filter pcss or pcf, or d-init 0";
  if (recipe.filter == Filter::rays && (recipe.select != Select::per_light || recipe.deliver != Deliver::textures))
    return "filter rays: needs select per-light and deliver textures (preset truth)";
  return std::nullopt;
}

}  // namespace chandelier
