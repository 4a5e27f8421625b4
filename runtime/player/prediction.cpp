// SPDX-License-Identifier: Apache-2.0
#include "player/prediction.h"

#include <fmt/format.h>

#include <cstdio>

#include "player/budget.h"
#include "player/image_files.h"
#include "player/stats.h"

namespace chandelier::player {
namespace {

std::string in_units(const Counter& counter, uint64_t value) {
  return counter.is_bytes ? fmt::format("{:.1f} MiB", static_cast<double>(value) / (1 << 20))
                          : fmt::format("{}", value);
}

std::string camera_text(const NamedCamera& camera) {
  if (camera.chosen != ChosenView::asked) return fmt::format("no camera: {}", name_of(camera.chosen));
  return camera.name.empty() ? "camera by numbers" : "camera " + camera.name;
}

void print_table(const Run& run) {
  fmt::print("{}: {}x{}, {}, {}\n", run.pack, run.settings.width, run.settings.height, camera_text(run.camera),
             run.preset);
  for (const Counter& counter : counters())
    if (counter.is_predicted) fmt::print("  {:<22}{:>14}\n", counter.name, in_units(counter, run.stats.*counter.value));
  fmt::print("  {:<22}{:>14}\n", "expected_rmse_shown", fmt::format("{:.4f}", *run.expected_rmse));
  const Recipe& recipe = run.settings.recipe;
  if (recipe.select == Select::light_clusters || !(recipe.max_maps || recipe.max_rmse))
    fmt::print("  {:<22}{:>14}\n", "d_init_m", fmt::format("{:.4g}", recipe.d_init_m));
}

}  // namespace

void run_prediction(const Options& options, const NamedCamera& camera, const pack::File& pack, const World& world) {
  const NamedRecipe& named = options.recipes.front();
  Predictor predictor(world);
  Run run;
  run.pack = options.pack.filename().string();
  run.preset = named.preset;
  run.camera = camera;
  run.settings = render_settings(options, named.recipe, camera.camera, {});
  const Prediction prediction = predictor.predict(run.settings);
  run.stats = prediction.stats;
  run.expected_rmse = predictor.expected_rmse(run.settings, prediction.plan);
  run.shared_maps = shared_maps(pack, world, prediction.plan.list);
  print_table(run);
  if (!options.stats.empty()) write_file(options.stats, prediction_json(run).dump(2) + "\n");
}

}  // namespace chandelier::player
