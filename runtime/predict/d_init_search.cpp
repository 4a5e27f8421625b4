// SPDX-License-Identifier: Apache-2.0
#include "predict/d_init_search.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace chandelier {
namespace {

constexpr int ladder_values = 96;
constexpr int halvings = 12;
constexpr float least_d_init_m = 1e-3f;

// 0, and d_init up to where the recipe has no smaller clusters any more.
std::vector<float> ladder(float farthest_m) {
  std::vector<float> values{0.0f};
  const float top = std::max(2.0f * farthest_m, 2.0f * least_d_init_m);
  for (int i = 0; i < ladder_values; ++i)
    values.push_back(least_d_init_m *
                     std::pow(top / least_d_init_m, static_cast<float>(i) / static_cast<float>(ladder_values - 1)));
  return values;
}

// Of the lights in view: the diagonal of the box around them.
float farthest_apart_m(const LightList& list) {
  glm::vec3 low(INFINITY), high(-INFINITY);
  for (const frame::FrameLight& light : list.lights) {
    low = glm::min(low, light.position_ws);
    high = glm::max(high, light.position_ws);
  }
  return list.lights.empty() ? 0.0f : glm::distance(low, high);
}

bool keeps(const Budget& budget, const FrameStats& stats) {
  return stats.shadow_maps <= budget.max_shadow_maps.value_or(UINT64_MAX) &&
         stats.shadow_bytes <= budget.max_shadow_bytes.value_or(UINT64_MAX);
}

}  // namespace

BudgetedPlan choose_d_init(Predictor& predictor, RenderSettings settings, const Budget& budget) {
  const auto at = [&](float d_init_m) {
    settings.recipe.d_init_m = d_init_m;
    Prediction prediction = predictor.plan(settings);
    const bool fits = keeps(budget, prediction.stats);
    return BudgetedPlan{d_init_m, fits, std::move(prediction)};
  };
  BudgetedPlan best = at(0.0f);
  float too_small = 0.0f;
  for (const float d_init_m : ladder(farthest_apart_m(best.prediction.plan.list))) {
    if (best.keeps_budget) break;
    too_small = best.d_init_m;
    best = at(d_init_m);
  }
  for (int i = 0; i < halvings && best.keeps_budget && best.d_init_m > 0.0f; ++i) {
    BudgetedPlan middle = at(0.5f * (too_small + best.d_init_m));
    if (middle.keeps_budget)
      best = std::move(middle);
    else
      too_small = middle.d_init_m;
  }
  return best;
}

}  // namespace chandelier
