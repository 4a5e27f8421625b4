// SPDX-License-Identifier: Apache-2.0
// Predictions and budgets on lights made in the test; whole scenes are in tests/scenes.
#include <gtest/gtest.h>

#include <random>

#include "predict/d_init_search.h"

namespace chandelier {
namespace {

// Lights in a flat box, seen from before it, and no triangles.
pack::Contents lights_in_a_box(uint32_t count, uint32_t seed) {
  std::mt19937 random(seed);
  const auto uniform = [&](float low, float high) {
    return low + (high - low) * static_cast<float>(random() >> 8) * 0x1p-24f;
  };
  pack::Contents pack;
  for (uint32_t i = 0; i < count; ++i) {
    pack::Light light;
    light.position_ws = {uniform(-5, 5), uniform(-1, 1), uniform(-5, 5)};
    light.range_m = uniform(2, 4);
    light.direction_ws = {0, -1, 0};
    light.type = pack::LightType::point;
    light.inner_cone_cos = 1;
    light.outer_cone_cos = -1;
    pack.lights.push_back(light);
  }
  return pack;
}

RenderSettings clustered(DistanceScaling scaling) {
  RenderSettings settings;
  settings.recipe.select = Select::light_clusters;
  settings.recipe.filter = Filter::pcf;
  settings.recipe.distance_scaling = scaling;
  settings.camera.eye_ws = {0, 0, 12};
  return settings;
}

TEST(Budget, IsKeptByAsManyMapsAsItAllows) {
  for (const DistanceScaling scaling : {DistanceScaling::grow, DistanceScaling::none}) {
    const pack::Contents pack = lights_in_a_box(100, 1);
    const pack::View view = pack::view_of(pack);
    Predictor predictor(view);
    const RenderSettings settings = clustered(scaling);
    uint64_t before = 0;
    for (const uint64_t most : {1, 2, 5, 10, 20, 40, 60, 80, 99}) {
      const BudgetedPlan plan = choose_d_init(predictor, settings, {.max_shadow_maps = most});
      EXPECT_TRUE(plan.keeps_budget) << most;
      EXPECT_LE(plan.prediction.stats.shadow_maps, most);
      EXPECT_GE(plan.prediction.stats.shadow_maps, before);
      before = plan.prediction.stats.shadow_maps;
      if (most <= 80) {  // above that the reference is drawn (reference_share)
        EXPECT_GE(before + before / 4 + 1, most);
      }
      // A little smaller, it makes too many.
      RenderSettings smaller = settings;
      smaller.recipe.d_init_m = plan.d_init_m * 0.995f;
      EXPECT_GT(predictor.plan(smaller).stats.shadow_maps, most);
      smaller.recipe.d_init_m = plan.d_init_m;
      EXPECT_EQ(predictor.plan(smaller).stats.shadow_maps, before);
    }
  }
}

TEST(Budget, LeavesLightsAloneThatItHolds) {
  const pack::Contents pack = lights_in_a_box(30, 2);
  const pack::View view = pack::view_of(pack);
  Predictor predictor(view);
  const BudgetedPlan plan = choose_d_init(predictor, clustered(DistanceScaling::grow), {.max_shadow_maps = 30});
  EXPECT_EQ(plan.d_init_m, 0.0f);
  EXPECT_TRUE(plan.keeps_budget);
  EXPECT_EQ(plan.prediction.plan.list.center, plan.prediction.plan.list.pack_light);
}

TEST(Budget, OfBytesIsThatOfMaps) {
  const pack::Contents pack = lights_in_a_box(50, 3);
  const pack::View view = pack::view_of(pack);
  Predictor predictor(view);
  RenderSettings settings = clustered(DistanceScaling::grow);
  settings.recipe.face_size_px = 256;  // 1.5 MiB a map
  const BudgetedPlan bytes = choose_d_init(predictor, settings, {.max_shadow_bytes = uint64_t{16} << 20});
  const BudgetedPlan maps = choose_d_init(predictor, settings, {.max_shadow_maps = 10});
  EXPECT_LE(bytes.prediction.stats.shadow_bytes, uint64_t{16} << 20);
  EXPECT_EQ(bytes.d_init_m, maps.d_init_m);
  const BudgetedPlan both =
      choose_d_init(predictor, settings, {.max_shadow_maps = 4, .max_shadow_bytes = uint64_t{16} << 20});
  EXPECT_LE(both.prediction.stats.shadow_maps, 4u);
}

TEST(Budget, SaysWhereNoClusterKeepsIt) {
  pack::Contents pack = lights_in_a_box(3, 4);
  for (pack::Light& light : pack.lights) light.range_m = 50;
  pack.lights[0].position_ws = {0, 0, -60};
  const pack::View view = pack::view_of(pack);
  Predictor predictor(view);
  RenderSettings settings = clustered(DistanceScaling::paper_formula);  // beyond z_far nothing is clustered
  settings.camera.eye_ws = {0, 0, 60};
  const BudgetedPlan plan = choose_d_init(predictor, settings, {.max_shadow_maps = 1});
  EXPECT_FALSE(plan.keeps_budget);
  EXPECT_GT(plan.prediction.stats.shadow_maps, 1u);
}

TEST(Prediction, CountsLightsMapsAndViews) {
  const pack::Contents pack = lights_in_a_box(40, 5);
  const pack::View view = pack::view_of(pack);
  Predictor predictor(view);
  RenderSettings settings = clustered(DistanceScaling::grow);
  settings.recipe.d_init_m = 0.8f;
  settings.recipe.face_size_px = 128;
  settings.recipe.shadow_budget_bytes = uint64_t{1} << 20;
  const FrameStats stats = predictor.predict(settings).stats;
  EXPECT_EQ(stats.lights, 40u);
  EXPECT_GT(stats.shadow_maps, 2u);
  EXPECT_LT(stats.shadow_maps, stats.lights_in_view);
  EXPECT_EQ(stats.shadow_views, 6 * stats.shadow_maps);
  EXPECT_EQ(stats.shadow_bytes, stats.shadow_maps * 6 * 4 * 128 * 128);
  EXPECT_EQ(stats.shadow_rounds, (stats.shadow_maps + 1) / 2);
  EXPECT_EQ(stats.shadow_triangles, 0u);
}

}  // namespace
}  // namespace chandelier
