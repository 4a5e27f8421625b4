// SPDX-License-Identifier: Apache-2.0
#include "player/budget.h"

#include <fmt/format.h>

#include <cstdio>
#include <utility>

#include "shadows/store/cube_bytes.h"

namespace chandelier::player {
namespace {

constexpr size_t most_names = 8;  // on stderr; --stats has them all

std::string name_of(const pack::File& pack, const World& world, LightId light) {
  const std::string_view name = pack.text(world.lights()[light].name);
  return name.empty() ? fmt::format("light {}", light) : std::string(name);
}

std::string in_words(const std::vector<SharedMap>& shared) {
  std::string text;
  for (size_t i = 0; i < shared.size() && i < most_names; ++i)
    text += fmt::format("{}{} ({}'s)", i == 0 ? "" : ", ", shared[i].light, shared[i].map_of);
  if (shared.size() > most_names) text += fmt::format(", and {} more", shared.size() - most_names);
  return text;
}

// `asked` is the recipe before.
void tell(const NamedRecipe& named, const Recipe& asked, const BudgetedPlan& plan, const Budget& budget) {
  const FrameStats& stats = plan.prediction.stats;
  const bool by_error = named.recipe.select == Select::error_driven;
  const bool had_d_init = budget.d_init_is_least && !by_error;
  const std::string how = by_error ? "selection by error" : fmt::format("d-init {:.4g} m", named.recipe.d_init_m);
  const uint64_t shadowed = stats.lights_in_view - stats.shadowless_in_view;
  const FrameStats one_each{.shadow_maps = shadowed, .shadow_bytes = shadowed * cube_bytes(named.recipe.face_size_px)};
  const bool is_limited = !keeps(one_each, budget);
  if (!plan.keeps_budget)
    fmt::print(stderr,
               "chandelier-play: warning: {}: no {} meets the budget; this one needs {} shadow maps, {} bytes\n",
               named.preset, by_error ? "selection" : "d-init", stats.shadow_maps, stats.shadow_bytes);
  if (plan.expected_rmse)
    fmt::print(stderr, "{}: {} makes {} shadow maps, expected RMSE {:.4f}\n", named.preset, how, stats.shadow_maps,
               *plan.expected_rmse);
  if (plan.expected_rmse && *plan.expected_rmse > double{*budget.max_error})
    fmt::print(stderr, "chandelier-play: warning: {}: --max-error {} is missed by {:.4f}; {}\n", named.preset,
               *budget.max_error, *plan.expected_rmse - double{*budget.max_error},
               is_limited ? "the limit of maps or bytes allows no less"
               : by_error ? "more maps do not lower it"
                          : "no d-init lowers it");
  if (!is_limited || !plan.keeps_budget || named.shared_maps->empty()) return;
  if (had_d_init && named.recipe.d_init_m == asked.d_init_m) return;
  const std::string wanted = had_d_init ? fmt::format("d-init {:.4g} m", asked.d_init_m)
                                        : fmt::format("a shadow map for each of {} lights", shadowed);
  fmt::print(stderr, "{}: over budget with {}: {} makes {}; without a map of their own: {}\n", named.preset, wanted,
             how, stats.shadow_maps, in_words(*named.shared_maps));
}

}  // namespace

std::vector<SharedMap> shared_maps(const pack::File& pack, const World& world, const LightList& list) {
  const std::vector<uint32_t> centers = centers_by_light(world, list);
  std::vector<SharedMap> shared;
  for (size_t i = 0; i < list.lights.size(); ++i)
    if (list.center[i] != list.light_id[i] && list.center[i] == centers[list.light_id[i]])
      shared.push_back({name_of(pack, world, list.light_id[i]), name_of(pack, world, list.center[i])});
  return shared;
}

void apply_budget(const Budget& budget, NamedRecipe& named, RenderSettings& settings, Predictor& predictor,
                  const pack::File& pack, const World& world) {
  if (!budget.is_given() || named.recipe.select == Select::per_light) return;
  const BudgetedPlan plan = keep_budget(predictor, settings, budget);
  const Recipe asked = std::exchange(named.recipe, plan.recipe);
  settings.recipe = plan.recipe;
  named.shared_maps = shared_maps(pack, world, plan.prediction.plan.list);
  named.expected_rmse = plan.expected_rmse;
  tell(named, asked, plan, budget);
}

void apply_budget(Options& options, const NamedCamera& camera, const pack::File& pack, const World& world) {
  Predictor predictor(world);
  for (NamedRecipe& named : options.recipes) {
    RenderSettings settings = render_settings(options, named.recipe, camera.camera, {});
    apply_budget(options.budget, named, settings, predictor, pack, world);
  }
}

}  // namespace chandelier::player
