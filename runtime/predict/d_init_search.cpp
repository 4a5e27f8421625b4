// SPDX-License-Identifier: Apache-2.0
#include "predict/d_init_search.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "shadows/store/cube_bytes.h"

namespace chandelier {
namespace {

constexpr float least_d_init_m = 1e-3f;

// What a recipe may have at most.
float most_d_init_m() {
  for (const Setting& setting : recipe_settings())
    if (setting.name == "d_init_m") return static_cast<float>(setting.typed_most);
  throw std::logic_error("a recipe has no d_init_m");
}

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
  const float top = std::clamp(2.0f * farthest_m, 2.0f * least_d_init_m, most_d_init_m());
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

// The first of ascending `values` that is good, or their number. One that is bad says of all up to bad_up_to() of it
// that they are bad too: halving finds two neighbours of which one is bad and one good, and only what is between that
// and the bad one may hold a good one before. What is looked at after the halving is no larger than settled_for() is
// told.
template <typename IsGood, typename BadUpTo, typename SettledFor>
size_t first_good(const std::vector<float>& values, IsGood is_good, BadUpTo bad_up_to, SettledFor settled_for) {
  if (is_good(values.front())) return 0;
  size_t bad = 0, good = values.size();
  while (bad + 1 < good) {
    const size_t middle = (bad + good) / 2;
    (is_good(values[middle]) ? good : bad) = middle;
  }
  if (good < values.size()) settled_for(values[good]);
  const auto unsure = std::upper_bound(values.begin(), values.end(), bad_up_to(values[bad])) - values.begin();
  for (auto i = static_cast<size_t>(unsure); i < bad; ++i)
    if (is_good(values[i])) return i;
  return good;
}

// The good value at `found`, or, where that is their number, the last one; from a good one on towards the bad one
// before it.
template <typename IsGood>
float narrowed_down(const std::vector<float>& values, size_t found, int halvings, IsGood is_good) {
  if (found == values.size()) return values.back();
  if (found == 0) return values.front();
  float good = values[found], bad = values[found - 1];
  for (int i = 0; i < halvings; ++i) {
    const float middle = 0.5f * (good + bad);
    (is_good(middle) ? good : bad) = middle;
  }
  return good;
}

uint64_t most_maps(const Budget& budget, uint32_t face_size_px) {
  return std::min(budget.max_shadow_maps.value_or(UINT64_MAX),
                  budget.max_shadow_bytes.value_or(UINT64_MAX) / cube_bytes(face_size_px));
}

// The smallest d_init that keeps maps and bytes.
float d_init_for_maps(Predictor& predictor, RenderSettings settings, const Budget& budget,
                      const std::vector<float>& values) {
  if (as_many_maps_up_to(settings.recipe, 1.0f) > 0.0f && settings.centers.empty()) {
    const uint64_t most = most_maps(budget, settings.recipe.face_size_px);
    ShadowMapCounter counter = predictor.counter(settings);
    const auto is_good = [&](float d_init_m) { return counter.count(d_init_m, most) <= most; };
    const auto bad_up_to = [&](float d_init_m) { return as_many_maps_up_to(settings.recipe, d_init_m); };
    const auto settled_for = [&](float d_init_m) { counter.stay_within(d_init_m); };
    return narrowed_down(values, first_good(values, is_good, bad_up_to, settled_for), for_maps.halvings, is_good);
  }
  const auto is_good = [&](float d_init_m) {
    settings.recipe.d_init_m = d_init_m;
    return keeps(predictor.plan(settings).stats, budget);
  };
  const auto found = std::find_if(values.begin(), values.end(), is_good) - values.begin();
  return narrowed_down(values, static_cast<size_t>(found), for_maps.halvings, is_good);
}

// The budget itself is the recipe's.
BudgetedPlan keep_by_error(Predictor& predictor, RenderSettings settings, const Budget& budget) {
  if (budget.max_shadow_maps || budget.max_shadow_bytes)
    settings.recipe.max_maps =
        static_cast<uint32_t>(std::min<uint64_t>(most_maps(budget, settings.recipe.face_size_px), UINT32_MAX));
  settings.recipe.max_rmse = budget.max_error;
  BudgetedPlan kept{.recipe = settings.recipe, .prediction = predictor.plan(settings)};
  kept.keeps_budget = keeps(kept.prediction.stats, budget);
  if (budget.max_error) kept.expected_rmse = predictor.expected_rmse(settings, kept.prediction.plan);
  return kept;
}

}  // namespace

bool keeps(const FrameStats& stats, const Budget& budget) {
  return stats.shadow_maps <= budget.max_shadow_maps.value_or(UINT64_MAX) &&
         stats.shadow_bytes <= budget.max_shadow_bytes.value_or(UINT64_MAX);
}

// Let s and t be centres with d, and c one of the centres with a smaller d' that cover all lights. Metric distances are
// from half the straight one up to it. Were both s and t covered by c, they would be within 4 d'_min(c) of
// each other, but are farther apart than d_min(s), and d_min(s) is at least d / d' (1 - 2 d' / z_far) d'_min(c), as |s
// c| is at most 2 d'_min(c). So where 4 d' <= d (1 - 2 d' / z_far), each centre with d has one with d' to itself. The
// reference's path, taken from a number of clusters on, only adds maps. Rounding is less than a thousandth.
float as_many_maps_up_to(const Recipe& recipe, float d_init_m) {
  if (recipe.select != Select::light_clusters || recipe.walls != WallTest::none || recipe.stability > 0.0f ||
      recipe.filter == Filter::rays)
    return 0.0f;
  return 0.999f * d_init_m / (4.0f + 2.0f * d_init_m / recipe.z_far_m);
}

BudgetedPlan choose_d_init(Predictor& predictor, RenderSettings settings, const Budget& budget) {
  const auto plan_at = [&](float d_init_m) {
    settings.recipe.d_init_m = d_init_m;
    return predictor.plan(settings);
  };
  const auto rmse_at = [&](float d_init_m) { return predictor.expected_rmse(settings, plan_at(d_init_m).plan); };

  BudgetedPlan best;
  const float farthest_m = farthest_apart_m(predictor.lights_in_view(settings), settings.recipe.z_far_m);
  if (budget.max_error) {
    std::vector<float> values = ladder(farthest_m, for_error);
    std::reverse(values.begin(), values.end());
    const auto is_good = [&](float d_init_m) { return rmse_at(d_init_m) <= double{*budget.max_error}; };
    const auto found = std::find_if(values.begin(), values.end(), is_good) - values.begin();
    best.prediction = plan_at(narrowed_down(values, static_cast<size_t>(found), for_error.halvings, is_good));
  }
  if (!budget.max_error || !keeps(best.prediction.stats, budget))
    best.prediction = plan_at(d_init_for_maps(predictor, settings, budget, ladder(farthest_m, for_maps)));
  best.recipe = settings.recipe;
  best.keeps_budget = keeps(best.prediction.stats, budget);
  if (budget.max_error) best.expected_rmse = rmse_at(best.recipe.d_init_m);
  return best;
}

BudgetedPlan keep_least_d_init(Predictor& predictor, const RenderSettings& settings, const Budget& budget,
                               const Prediction& wanted) {
  const bool is_kept = keeps(wanted.stats, budget);
  if (is_kept || settings.recipe.select != Select::light_clusters)
    return {.recipe = settings.recipe, .keeps_budget = is_kept, .expected_rmse = {}, .prediction = wanted};
  return choose_d_init(predictor, settings, budget);
}

BudgetedPlan keep_budget(Predictor& predictor, const RenderSettings& settings, const Budget& budget) {
  if (settings.recipe.select == Select::error_driven) return keep_by_error(predictor, settings, budget);
  if (budget.d_init_is_least) return keep_least_d_init(predictor, settings, budget, predictor.plan(settings));
  return choose_d_init(predictor, settings, budget);
}

}  // namespace chandelier
