// SPDX-License-Identifier: Apache-2.0
// The C interface over frame_plan.h and d_init_search.h. No exception leaves it.
#include <algorithm>
#include <exception>
#include <string_view>

#include "light_range.h"
#include "preview/chandelier_preview.h"
#include "preview/light_columns.h"

namespace chandelier::preview {
namespace {

// The preview offers no selection by error, which alone would read them.
std::vector<MeanMaterial> no_materials(const pack::View&) {
  return {};
}

// A world of lights alone.
World world_of(const Lights& lights) {
  pack::View pack;
  pack.lights = lights.lights;
  return World(pack);
}

// What the settings ask for, and what the budget leads to: the same where it is kept.
struct Plans {
  Prediction wanted;
  BudgetedPlan budgeted;
  bool over_budget = false;
};

Plans plan(const World& world, const RenderSettings& settings, const Budget& budget) {
  Predictor predictor(world, no_materials);
  Plans plans{.wanted = predictor.plan(settings)};
  plans.over_budget = !keeps(plans.wanted.stats, budget);
  plans.budgeted = keep_least_d_init(predictor, settings, budget, plans.wanted);
  return plans;
}

void check(const ChandelierPreviewResult& result, uint32_t count) {
  check_size(result.struct_bytes, sizeof result, "result");
  const bool has_arrays =
      result.center_of_light || result.range_of_light_m || result.over_budget_of_light || result.clusters;
  if (has_arrays && result.capacity < count)
    throw InputError("result: capacity is below the number of lights (" + std::to_string(result.capacity) + " for " +
                     std::to_string(count) + ")");
}

uint32_t put_over_budget(const Lights& lights, const Plans& plans, uint32_t count, uint8_t* over_budget_of_light) {
  if (over_budget_of_light) std::fill_n(over_budget_of_light, count, uint8_t{0});
  uint32_t lost = 0;
  for (uint32_t i = 0; i < lights.lights.size(); ++i) {
    const bool loses = plans.wanted.stats.centers[i] == i && plans.budgeted.prediction.stats.centers[i] != i;
    if (loses && over_budget_of_light) over_budget_of_light[lights.numbers[i]] = 1;
    lost += loses;
  }
  return lost;
}

void put_lights(const Lights& lights, const Prediction& prediction, uint32_t count, ChandelierPreviewResult& result) {
  if (result.center_of_light) std::fill_n(result.center_of_light, count, CHANDELIER_PREVIEW_NONE);
  if (result.range_of_light_m) std::fill_n(result.range_of_light_m, count, 0.0f);
  for (uint32_t i = 0; i < lights.lights.size(); ++i) {
    const uint32_t center = prediction.stats.centers[i];
    if (result.center_of_light && center != pack::none)
      result.center_of_light[lights.numbers[i]] = lights.numbers[center];
    if (result.range_of_light_m) result.range_of_light_m[lights.numbers[i]] = lights.lights[i].range_m;
  }
}

void put_clusters(const World& world, const Lights& lights, const LightList& list, const Recipe& recipe,
                  const Camera& camera, ChandelierPreviewResult& result) {
  result.cluster_count = static_cast<uint32_t>(list.maps.size());
  if (!result.clusters) return;
  const std::vector<MapMeasures> measures = measure_maps(world, list, recipe, camera);
  for (size_t i = 0; i < list.maps.size(); ++i) {
    const frame::ShadowMap& map = list.maps[i];
    result.clusters[i] = {.center = lights.numbers[list.center[map.first_light]],
                          .light_count = map.light_count,
                          .d_min_m = measures[i].d_min_m,
                          .range_m = map.range_m,
                          .spread_m = measures[i].spread_m};
  }
}

ChandelierPreviewBill bill(const Plans& plans, uint32_t lights_over_budget) {
  const FrameStats& stats = plans.budgeted.prediction.stats;
  return {.lights = static_cast<uint32_t>(stats.lights),
          .lights_in_view = static_cast<uint32_t>(stats.lights_in_view),
          .shadowless_in_view = static_cast<uint32_t>(stats.shadowless_in_view),
          .shadow_maps = static_cast<uint32_t>(stats.shadow_maps),
          .shadow_views = static_cast<uint32_t>(stats.shadow_views),
          .wanted_shadow_maps = static_cast<uint32_t>(plans.wanted.stats.shadow_maps),
          .shadow_bytes = stats.shadow_bytes,
          .wanted_shadow_bytes = plans.wanted.stats.shadow_bytes,
          .lights_over_budget = lights_over_budget,
          .d_init_m = plans.budgeted.recipe.d_init_m,
          .reference_path = static_cast<uint32_t>(stats.reference_path),
          .over_budget = plans.over_budget,
          .misses_budget = !plans.budgeted.keeps_budget};
}

void select(const ChandelierPreviewLights& lights, const ChandelierPreviewSettings& asked,
            const ChandelierPreviewCamera& camera, ChandelierPreviewResult& result) {
  check_size(lights.struct_bytes, sizeof lights, "lights");
  check_size(asked.struct_bytes, sizeof asked, "settings");
  check_size(camera.struct_bytes, sizeof camera, "camera");
  RenderSettings settings;
  settings.recipe = read_recipe(asked);
  read_camera(camera, settings);
  check(result, lights.count);
  const Lights read = read_lights(lights, asked.range_threshold_lx);
  const World world = world_of(read);
  const Plans plans = plan(world, settings, read_budget(asked));
  const Prediction& prediction = plans.budgeted.prediction;
  put_lights(read, prediction, lights.count, result);
  put_clusters(world, read, prediction.plan.list, plans.budgeted.recipe, settings.camera, result);
  result.bill = bill(plans, put_over_budget(read, plans, lights.count, result.over_budget_of_light));
}

void put_text(std::string_view text, char* to, size_t bytes) {
  if (!to || bytes == 0) return;
  const size_t kept = std::min(text.size(), bytes - 1);
  std::copy_n(text.data(), kept, to);
  to[kept] = '\0';
}

}  // namespace
}  // namespace chandelier::preview

using namespace chandelier;

uint32_t chandelier_preview_abi(void) {
  return CHANDELIER_PREVIEW_ABI;
}

void chandelier_preview_defaults(ChandelierPreviewSettings* settings) {
  if (!settings) return;
  const Recipe recipe;
  *settings = {.struct_bytes = sizeof *settings,
               .select = static_cast<uint32_t>(Select::light_clusters),
               .filter = static_cast<uint32_t>(Filter::pcss),
               .distance_scaling = static_cast<uint32_t>(recipe.distance_scaling),
               .dynamic_lights = static_cast<uint32_t>(recipe.dynamic_lights),
               .face_size_px = recipe.face_size_px,
               .d_init_m = recipe.d_init_m,
               .z_far_m = recipe.z_far_m,
               .reference_share = recipe.reference_share,
               .range_threshold_lx = pack::default_range_threshold_lx};
}

int32_t chandelier_preview_select(const ChandelierPreviewLights* lights, const ChandelierPreviewSettings* settings,
                                  const ChandelierPreviewCamera* camera, ChandelierPreviewResult* result,
                                  char* error_text, size_t error_bytes) {
  preview::put_text({}, error_text, error_bytes);
  try {
    if (!lights || !settings || !camera || !result)
      throw preview::InputError("lights, settings, camera and result: one of them is null");
    preview::select(*lights, *settings, *camera, *result);
    return CHANDELIER_PREVIEW_OK;
  } catch (const preview::InputError& error) {
    preview::put_text(error.what(), error_text, error_bytes);
    return CHANDELIER_PREVIEW_BAD_INPUT;
  } catch (const std::exception& error) {
    preview::put_text(error.what(), error_text, error_bytes);
  } catch (...) {
    preview::put_text("unknown error", error_text, error_bytes);
  }
  return CHANDELIER_PREVIEW_FAILED;
}
