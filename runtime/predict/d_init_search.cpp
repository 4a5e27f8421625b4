// SPDX-License-Identifier: Apache-2.0
#include "predict/d_init_search.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "shadows/store/cube_array.h"

namespace chandelier {
namespace {

constexpr float least_d_init_m = 1e-3f;

// How finely d_init is looked through: an error takes much longer to tell than a number of maps.
struct Effort {
  int ladder_values;
  int halvings;
};
constexpr Effort for_maps{96, 12};
constexpr Effort for_error{32, 4};

// 0, and d_init up to where every light is within d_min of every other, evenly in its logarithm.
std::vector<float> ladder(float farthest_m, const Effort& effort) {
  std::vector<float> values{0.0f};
  const float top = std::max(2.0f * farthest_m, 2.0f * least_d_init_m);
  for (int i = 0; i < effort.ladder_values; ++i)
    values.push_back(least_d_init_m * std::pow(top / least_d_init_m,
                                               static_cast<float>(i) / static_cast<float>(effort.ladder_values - 1)));
  return values;
}

// Of the lights in view: the diagonal of the box around them. Directional lights stand z_far from wherever one is.
float farthest_apart_m(const LightList& list, float z_far_m) {
  glm::vec3 low(INFINITY), high(-INFINITY);
  float suns_m = 0.0f;
  for (const frame::FrameLight& light : list.lights) {
    if (light.type == static_cast<uint32_t>(pack::LightType::directional)) {
      suns_m = 2.0f * z_far_m;
      continue;
    }
    low = glm::min(low, light.position_ws);
    high = glm::max(high, light.position_ws);
  }
  return std::max(suns_m, low.x <= high.x ? glm::distance(low, high) : 0.0f);
}

// Takes the first of `values` that is good, the last where none is, and from a good one goes on towards the bad one
// before it.
template <typename IsGood>
float first_good(const std::vector<float>& values, int halvings, IsGood is_good) {
  const auto found = std::find_if(values.begin(), values.end(), is_good);
  if (found == values.end()) return values.back();
  if (found == values.begin()) return *found;
  float good = *found, bad = *(found - 1);
  for (int i = 0; i < halvings; ++i) {
    const float middle = 0.5f * (good + bad);
    (is_good(middle) ? good : bad) = middle;
  }
  return good;
}

bool fits(const FrameStats& stats, const Budget& budget) {
  return stats.shadow_maps <= budget.max_shadow_maps.value_or(UINT64_MAX) &&
         stats.shadow_bytes <= budget.max_shadow_bytes.value_or(UINT64_MAX);
}

// The budget itself is the recipe's.
BudgetedPlan keep_by_error(Predictor& predictor, RenderSettings settings, const Budget& budget) {
  uint64_t maps = budget.max_shadow_maps.value_or(UINT32_MAX);
  if (budget.max_shadow_bytes)
    maps = std::min(maps, *budget.max_shadow_bytes / cube_bytes(settings.recipe.face_size_px));
  if (budget.max_shadow_maps || budget.max_shadow_bytes)
    settings.recipe.max_maps = static_cast<uint32_t>(std::min<uint64_t>(maps, UINT32_MAX));
  settings.recipe.max_rmse = budget.max_error;
  BudgetedPlan kept{.recipe = settings.recipe, .prediction = predictor.plan(settings)};
  kept.keeps_budget = fits(kept.prediction.stats, budget);
  if (budget.max_error) kept.expected_rmse = predictor.expected_rmse(settings, kept.prediction.plan);
  return kept;
}

}  // namespace

BudgetedPlan choose_d_init(Predictor& predictor, RenderSettings settings, const Budget& budget) {
  const auto plan_at = [&](float d_init_m) {
    settings.recipe.d_init_m = d_init_m;
    return predictor.plan(settings);
  };
  const auto rmse_at = [&](float d_init_m) { return predictor.expected_rmse(settings, plan_at(d_init_m).plan); };

  const float farthest_m = farthest_apart_m(plan_at(0.0f).plan.list, settings.recipe.z_far_m);
  float d_init_m = 0.0f;
  if (budget.max_error) {
    std::vector<float> values = ladder(farthest_m, for_error);
    std::reverse(values.begin(), values.end());
    d_init_m = first_good(values, for_error.halvings,
                          [&](float tried_m) { return rmse_at(tried_m) <= double{*budget.max_error}; });
  }
  if (!fits(plan_at(d_init_m).stats, budget))
    d_init_m = first_good(ladder(farthest_m, for_maps), for_maps.halvings,
                          [&](float tried_m) { return fits(plan_at(tried_m).stats, budget); });
  BudgetedPlan best{.prediction = plan_at(d_init_m)};
  best.recipe = settings.recipe;
  best.keeps_budget = fits(best.prediction.stats, budget);
  if (budget.max_error) best.expected_rmse = rmse_at(d_init_m);
  return best;
}

BudgetedPlan keep_budget(Predictor& predictor, const RenderSettings& settings, const Budget& budget) {
  return settings.recipe.select == Select::error_driven ? keep_by_error(predictor, settings, budget)
                                                        : choose_d_init(predictor, settings, budget);
}

}  // namespace chandelier
