// SPDX-License-Identifier: Apache-2.0
// From a budget to the d_init that keeps it.
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

  bool is_given() const { return max_shadow_maps || max_shadow_bytes || max_error; }
};

struct BudgetedPlan {
  float d_init_m = 0.0f;
  bool keeps_budget = true;             // false where even the largest d_init makes too many maps
  std::optional<double> expected_rmse;  // where max_error is given: above it where maps or bytes do not allow less
  Prediction prediction;                // with that d_init; draws and triangles are 0
};

/// With max_error the largest d_init, which is the fewest maps, that is expected to keep it; where that is more than
/// the budget of maps and bytes, or without max_error, the smallest d_init that keeps these. README.md of this folder
/// says how it is looked for.
BudgetedPlan choose_d_init(Predictor& predictor, RenderSettings settings, const Budget& budget);

}  // namespace chandelier
