// SPDX-License-Identifier: Apache-2.0
// The renderer's own plan_frame() and planned_stats(), and the cull stage on the CPU.
#include "predict/prediction.h"

#include <algorithm>

#include "shadows/cull/count_casters.h"
#include "shadows/store/cube_bytes.h"

namespace chandelier {
namespace {

// What lavapipe and desktop GPUs allow.
constexpr uint64_t most_layers = 2048;
constexpr uint64_t most_visibility_bytes = uint64_t{128} << 20;

// A device may allow less: then the frame takes more passes over groups of maps, and holds less at a time, which
// changes no other counter.
GroupLimits limits_without_device(const pack::View& pack, const Recipe& recipe, uint64_t most_draws) {
  const uint64_t cubes = recipe.shadow_budget_bytes / cube_bytes(recipe.face_size_px);
  return {.cubes = static_cast<uint32_t>(std::clamp<uint64_t>(cubes, 1, most_layers / 6)),
          .layer_size_px = recipe.face_size_px,
          .views = most_views(pack.batch_instances.size(), most_draws),
          .visibility_bytes = most_visibility_bytes};
}

}  // namespace

Prediction Predictor::plan(const RenderSettings& settings) {
  Prediction prediction;
  prediction.plan =
      plan_frame(world_, settings, limits_without_device(world_.pack(), settings.recipe, settings.most_caster_draws),
                 &surroundings_);
  prediction.stats = planned_stats(world_, prediction.plan, settings);
  return prediction;
}

LightList Predictor::lights_in_view(const RenderSettings& settings) const {
  Recipe recipe = settings.recipe;
  recipe.select = Select::per_light;
  return select_lights(world_, recipe, settings.camera, aspect_of(settings),
                       {.out_of_view = settings.lights_out_of_view});
}

double Predictor::expected_rmse(const RenderSettings& settings, const FramePlan& plan) {
  if (plan.recipe.filter == Filter::hard && plan.list.center == plan.list.light_id) return 0.0;  // the reference
  return chandelier::expected_rmse(plan.list, plan.recipe, settings.camera, aspect_of(settings),
                                   {.surroundings = &surroundings_,
                                    .ambient = settings.ambient,
                                    .headlight = settings.headlight,
                                    .exposure_ev = settings.exposure_ev});
}

Prediction Predictor::predict(const RenderSettings& settings) {
  Prediction prediction = plan(settings);
  const std::span<const frame::ShadowView> views(prediction.plan.views);
  std::vector<ViewGroup> groups;
  for (const MapGroup& group : prediction.plan.groups)
    if (group.view_count > 0) groups.push_back({group.first_view, group.view_count});
  const CasterCounts counts = count_casters(settings.recipe.cull, views.first(prediction.stats.shadow_views), groups,
                                            settings.most_caster_draws, world_);
  prediction.stats.shadow_draws = counts.draws;
  prediction.stats.shadow_triangles = counts.triangles;
  prediction.stats.shadow_overflow_passes = counts.further_passes;
  return prediction;
}

}  // namespace chandelier
