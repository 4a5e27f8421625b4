// SPDX-License-Identifier: Apache-2.0
// From a budget to the recipe that keeps it.
#pragma once

#include <cstdint>
#include <optional>

#include "predict/prediction.h"

namespace chandelier {

/// What a frame's shadow maps may take and how wrong it may be; each where it is given.
struct Budget {
  std::optional<uint64_t> max_shadow_maps;
  std::optional<uint64_t> max_shadow_bytes;
  std::optional<float> max_error;  // expected RMSE of the shown picture
  bool d_init_is_least = false;    // the recipe's, for maps and bytes: see keep_least_d_init()

  bool is_given() const { return max_shadow_maps || max_shadow_bytes || max_error; }
};

/// Its maps and bytes; what error to expect takes more than these counters.
bool keeps(const FrameStats& stats, const Budget& budget);

struct BudgetedPlan {
  Recipe recipe;             // as asked for, but d_init_m, or max_maps and max_rmse of error-driven selection
  bool keeps_budget = true;  // false where even the fewest maps that can be are too many
  std::optional<double> expected_rmse;  // where max_error is given: above it where maps or bytes do not allow less
  Prediction prediction;                // of that recipe; draws and triangles are 0
};

/// A d_init up to which there are at least as many shadow maps as with this one, by light clusters without walls and
/// stability (README.md of this folder); 0 where the recipe is another.
float as_many_maps_up_to(const Recipe& recipe, float d_init_m);

/// With max_error the largest d_init, which is the fewest maps, that is expected to keep it; where that is more than
/// the budget of maps and bytes, or without max_error, the smallest d_init that keeps these. README.md of this folder
/// says how it is looked for.
BudgetedPlan choose_d_init(Predictor& predictor, RenderSettings settings, const Budget& budget);

/// Of maps and bytes: the settings' own d_init, of which `wanted` is the plan, where that keeps them, else
/// choose_d_init()'s. A recipe without light clusters stays as it is.
BudgetedPlan keep_least_d_init(Predictor& predictor, const RenderSettings& settings, const Budget& budget,
                               const Prediction& wanted);

/// What the budget asks for, of any recipe: error-driven selection needs no d_init, but is told the budget, which it
/// keeps anew in every view, as far as lights that keep a map of their own allow.
BudgetedPlan keep_budget(Predictor& predictor, const RenderSettings& settings, const Budget& budget);

}  // namespace chandelier
