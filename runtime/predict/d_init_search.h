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

  bool is_given() const { return max_shadow_maps || max_shadow_bytes; }
};

struct BudgetedPlan {
  float d_init_m = 0.0f;
  bool keeps_budget = true;  // false where even the largest d_init makes too many maps
  Prediction prediction;     // with that d_init; draws and triangles are 0
};

/// The smallest d_init, which is the most maps, that keeps the budget. Looks at 0 and at 96 values from 1 mm up to
/// where every light is within d_min of every other, evenly in their logarithm, from below: the number of maps may rise
/// with d_init too. Then halves the way to the value before twelve times.
BudgetedPlan choose_d_init(Predictor& predictor, RenderSettings settings, const Budget& budget);

}  // namespace chandelier
