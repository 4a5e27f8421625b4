// SPDX-License-Identifier: Apache-2.0
// Predictions and budgets on lights made in the test; whole scenes are in tests/scenes.
#include <gtest/gtest.h>

#include <random>

#include "bake/bake.h"
#include "predict/d_init_search.h"
#include "shadows/cull/count_casters.h"

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
    const World world(view);
    Predictor predictor(world);
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
      smaller.recipe.d_init_m = plan.recipe.d_init_m * 0.995f;
      EXPECT_GT(predictor.plan(smaller).stats.shadow_maps, most);
      smaller.recipe.d_init_m = plan.recipe.d_init_m;
      EXPECT_EQ(predictor.plan(smaller).stats.shadow_maps, before);
    }
  }
}

TEST(Budget, LeavesLightsAloneThatItHolds) {
  const pack::Contents pack = lights_in_a_box(30, 2);
  const pack::View view = pack::view_of(pack);
  const World world(view);
  Predictor predictor(world);
  const BudgetedPlan plan = choose_d_init(predictor, clustered(DistanceScaling::grow), {.max_shadow_maps = 30});
  EXPECT_EQ(plan.recipe.d_init_m, 0.0f);
  EXPECT_TRUE(plan.keeps_budget);
  EXPECT_EQ(plan.prediction.plan.list.center, plan.prediction.plan.list.light_id);
}

TEST(Budget, OfBytesIsThatOfMaps) {
  const pack::Contents pack = lights_in_a_box(50, 3);
  const pack::View view = pack::view_of(pack);
  const World world(view);
  Predictor predictor(world);
  RenderSettings settings = clustered(DistanceScaling::grow);
  settings.recipe.face_size_px = 256;  // 1.5 MiB a map
  const BudgetedPlan bytes = choose_d_init(predictor, settings, {.max_shadow_bytes = uint64_t{16} << 20});
  const BudgetedPlan maps = choose_d_init(predictor, settings, {.max_shadow_maps = 10});
  EXPECT_LE(bytes.prediction.stats.shadow_bytes, uint64_t{16} << 20);
  EXPECT_EQ(bytes.recipe.d_init_m, maps.recipe.d_init_m);
  const BudgetedPlan both =
      choose_d_init(predictor, settings, {.max_shadow_maps = 4, .max_shadow_bytes = uint64_t{16} << 20});
  EXPECT_LE(both.prediction.stats.shadow_maps, 4u);
}

// Points, spots, suns and groups at all distances.
pack::Contents mixed_lights(uint32_t seed) {
  pack::Contents pack = lights_in_a_box(5 + seed % 60, seed);
  std::mt19937 random(seed);
  for (pack::Light& light : pack.lights) {
    const float angle = static_cast<float>(random() % 628) * 0.01f;
    light.direction_ws = {std::cos(angle), std::sin(angle), 0.0f};
    light.intensity = 1.0f;
    light.position_ws *= 1.0f + static_cast<float>(random() % 4);
    if (random() % 8 == 0) light.group = 1 + random() % 2;
    if (random() % 8 == 0) light.shadowless = 1;
    if (random() % 8 == 0) light.radius_m = 0.1f;
    if (random() % 9 == 0) light.type = pack::LightType::directional;
    if (light.type == pack::LightType::directional || random() % 2 == 0) continue;
    light.type = pack::LightType::spot;
    light.outer_cone_cos = 0.7f;
  }
  return pack;
}

RenderSettings mixed_settings(uint32_t seed) {
  RenderSettings settings = clustered(static_cast<DistanceScaling>(seed % 3));
  settings.recipe.reference_share = seed % 4 == 0 ? 2.0f : 0.85f;
  settings.recipe.z_far_m = 5.0f + static_cast<float>(seed % 50);
  settings.lights_out_of_view = seed % 5 == 0;
  return settings;
}

TEST(Budget, CountsTheMapsOfAPlan) {
  for (uint32_t seed = 0; seed < 200; ++seed) {
    SCOPED_TRACE(seed);
    const pack::Contents pack = mixed_lights(seed);
    const World world(pack::view_of(pack));
    Predictor predictor(world);
    RenderSettings settings = mixed_settings(seed);
    ShadowMapCounter counter = predictor.counter(settings);
    for (const float d_init_m : {0.0f, 0.1f, 0.7f, 2.0f, 9.0f, 70.0f}) {
      settings.recipe.d_init_m = d_init_m;
      const uint64_t maps = predictor.plan(settings).stats.shadow_maps;
      EXPECT_EQ(counter.count(d_init_m, 1000), maps);
      if (maps > 0) {
        EXPECT_GT(counter.count(d_init_m, maps - 1), maps - 1);
      }
      RenderSettings smaller = settings;
      for (const float part : {1.0f, 0.9f, 0.5f}) {
        smaller.recipe.d_init_m = part * as_many_maps_up_to(settings.recipe, d_init_m);
        EXPECT_GE(predictor.plan(smaller).stats.shadow_maps, maps) << d_init_m;
      }
    }
  }
}

// What is found by halving and counting is what looking at one d_init after another finds, from 0 on.
TEST(Budget, IsKeptByTheFirstDInitOfAllThatKeepsIt) {
  for (uint32_t seed = 0; seed < 150; ++seed) {
    SCOPED_TRACE(seed);
    const pack::Contents pack = mixed_lights(seed);
    const World world(pack::view_of(pack));
    Predictor predictor(world);
    RenderSettings settings = mixed_settings(seed);
    const Budget budget{.max_shadow_maps = 1 + seed % 23};
    const BudgetedPlan plan = choose_d_init(predictor, settings, budget);
    settings.centers.assign(pack.lights.size(), pack::none);  // holds none, but is not counted any more
    EXPECT_EQ(choose_d_init(predictor, settings, budget).recipe.d_init_m, plan.recipe.d_init_m);
  }
}

// Where the least d_init breaks a budget, what keeps it is what is found without one.
TEST(Budget, LeavesTheLeastDInitThatKeepsIt) {
  uint32_t kept = 0, widened = 0;
  for (uint32_t seed = 0; seed < 100; ++seed) {
    SCOPED_TRACE(seed);
    const pack::Contents pack = mixed_lights(seed);
    const World world(pack::view_of(pack));
    Predictor predictor(world);
    RenderSettings settings = mixed_settings(seed);
    settings.recipe.d_init_m = 0.2f * static_cast<float>(1 + seed % 17);
    const uint64_t wanted = predictor.plan(settings).stats.shadow_maps;
    Budget budget{.max_shadow_maps = 1 + seed % 23};
    const BudgetedPlan from_zero = keep_budget(predictor, settings, budget);
    budget.d_init_is_least = true;
    const BudgetedPlan plan = keep_budget(predictor, settings, budget);
    const bool is_kept = wanted <= *budget.max_shadow_maps;
    EXPECT_EQ(plan.recipe.d_init_m, is_kept ? settings.recipe.d_init_m : from_zero.recipe.d_init_m);
    EXPECT_EQ(plan.keeps_budget, is_kept || from_zero.keeps_budget);
    settings.recipe.d_init_m = plan.recipe.d_init_m;
    EXPECT_EQ(plan.prediction.stats.shadow_maps, predictor.plan(settings).stats.shadow_maps);
    kept += is_kept;
    widened += !is_kept && from_zero.keeps_budget;
  }
  EXPECT_GT(kept, 10u);
  EXPECT_GT(widened, 20u);
}

TEST(Budget, SaysWhereNoClusterKeepsIt) {
  pack::Contents pack = lights_in_a_box(3, 4);
  for (pack::Light& light : pack.lights) light.range_m = 50;
  pack.lights[0].position_ws = {0, 0, -60};
  const pack::View view = pack::view_of(pack);
  const World world(view);
  Predictor predictor(world);
  RenderSettings settings = clustered(DistanceScaling::paper_formula);  // beyond z_far nothing is clustered
  settings.camera.eye_ws = {0, 0, 60};
  const BudgetedPlan plan = choose_d_init(predictor, settings, {.max_shadow_maps = 1});
  EXPECT_FALSE(plan.keeps_budget);
  EXPECT_GT(plan.prediction.stats.shadow_maps, 1u);
}

// A floor with posts on it and lamps above, as the camera of clustered() sees it.
pack::Contents posts_on_a_floor() {
  baker::Scene scene;
  scene.materials.emplace_back();
  baker::Primitive& out = scene.meshes.emplace_back().primitives.emplace_back();
  const auto add_quad = [&](const glm::vec3& a, const glm::vec3& u, const glm::vec3& v) {
    const auto first = static_cast<uint32_t>(out.vertices.size());
    for (const glm::vec3& corner : {a, a + u, a + u + v, a + v}) out.vertices.push_back({.position_ls = corner});
    for (const uint32_t corner : {0, 1, 2, 0, 2, 3}) out.indices.push_back(first + corner);
  };
  add_quad({-6, -2, 6}, {12, 0, 0}, {0, 0, -12});
  for (int i = 0; i < 16; ++i) {
    const float x = -4.0f + 2.5f * static_cast<float>(i % 4), z = -4.0f + 2.5f * static_cast<float>(i / 4);
    add_quad({x, -2, z}, {0.3f, 0, 0}, {0, 1.5f, 0});
    add_quad({x, -2, z}, {0, 0, -0.3f}, {0, 1.5f, 0});
  }
  scene.instances.emplace_back().mesh = 0;
  for (int i = 0; i < 24; ++i) {
    const float x = -4.0f + 1.6f * static_cast<float>(i % 6), z = -4.0f + 2.4f * static_cast<float>(i / 6);
    scene.lights.push_back({.name = std::to_string(i), .position_ws = {x, 0.5f, z}, .intensity = 3, .range_m = 5.0f});
  }
  baker::Report report;
  baker::Warnings warnings;
  return baker::bake(std::move(scene), {}, baker::Progress(false), report, warnings);
}

RenderSettings small_picture() {
  RenderSettings settings = clustered(DistanceScaling::grow);
  settings.width = 160;
  settings.height = 90;
  return settings;
}

TEST(Budget, OfErrorIsKeptByAsFewMapsAsDo) {
  const pack::Contents pack = posts_on_a_floor();
  const pack::View view = pack::view_of(pack);
  const World world(view);
  Predictor predictor(world);
  RenderSettings settings = small_picture();
  settings.recipe.d_init_m = 50;
  const Prediction coarse = predictor.plan(settings);
  ASSERT_EQ(coarse.stats.shadow_maps, 1u);
  const double worst = predictor.expected_rmse(settings, coarse.plan);
  ASSERT_GT(worst, 0.02);

  uint64_t before = 25;
  for (const float share : {0.0f, 0.3f, 0.6f, 2.0f}) {
    const float most = share * static_cast<float>(worst);
    const BudgetedPlan plan = choose_d_init(predictor, settings, {.max_error = most});
    ASSERT_TRUE(plan.expected_rmse);
    EXPECT_LE(*plan.expected_rmse, most);
    EXPECT_LE(plan.prediction.stats.shadow_maps, before);
    before = plan.prediction.stats.shadow_maps;
  }
  EXPECT_EQ(before, 1u);
}

TEST(Budget, OfMapsComesBeforeThatOfError) {
  const pack::Contents pack = posts_on_a_floor();
  const pack::View view = pack::view_of(pack);
  const World world(view);
  Predictor predictor(world);
  RenderSettings settings = small_picture();
  const BudgetedPlan plan = choose_d_init(predictor, settings, {.max_shadow_maps = 4, .max_error = 1e-4f});
  EXPECT_TRUE(plan.keeps_budget);
  EXPECT_LE(plan.prediction.stats.shadow_maps, 4u);
  ASSERT_TRUE(plan.expected_rmse);
  EXPECT_GT(*plan.expected_rmse, 1e-3);
  // An error that many maps keep is none that these few could not.
  const BudgetedPlan easy = choose_d_init(predictor, settings, {.max_shadow_maps = 20, .max_error = 1.0f});
  EXPECT_EQ(easy.prediction.stats.shadow_maps, 1u);
}

TEST(Budget, IsWhatSelectionByErrorKeeps) {
  const pack::Contents pack = posts_on_a_floor();
  const pack::View view = pack::view_of(pack);
  const World world(view);
  Predictor predictor(world);
  RenderSettings settings = small_picture();
  settings.recipe.select = Select::error_driven;
  settings.recipe.filter = Filter::hard;
  settings.recipe.face_size_px = 256;  // 1.5 MiB a map
  double before = INFINITY;
  for (const uint64_t most : {1, 3, 6, 12, 24}) {
    const BudgetedPlan plan = keep_budget(predictor, settings, {.max_shadow_maps = most, .max_error = 0.0f});
    EXPECT_TRUE(plan.keeps_budget);
    EXPECT_EQ(plan.prediction.stats.shadow_maps, most) << "no error is too small for a map more";
    EXPECT_EQ(plan.recipe.d_init_m, settings.recipe.d_init_m);
    EXPECT_LT(*plan.expected_rmse, before);
    before = *plan.expected_rmse;
    const BudgetedPlan maps = keep_budget(predictor, settings, {.max_shadow_maps = most});
    EXPECT_EQ(maps.prediction.plan.list.center, plan.prediction.plan.list.center);
    const BudgetedPlan bytes = keep_budget(predictor, settings, {.max_shadow_bytes = most * 6 * 4 * 256 * 256 + 1});
    EXPECT_EQ(bytes.prediction.plan.list.center, plan.prediction.plan.list.center);
    const BudgetedPlan error = keep_budget(predictor, settings, {.max_error = static_cast<float>(before) + 1e-6f});
    EXPECT_LE(error.prediction.stats.shadow_maps, most);
    EXPECT_LE(*error.expected_rmse, before + 2e-6);
  }
  EXPECT_EQ(before, 0.0) << "a hard map for each light is what errors are measured against";
  const BudgetedPlan none = keep_budget(predictor, settings, {.max_shadow_bytes = 1});
  EXPECT_FALSE(none.keeps_budget);
  EXPECT_EQ(none.prediction.stats.shadow_maps, 1u);
}

// The reference would give each light of a group a map of its own.
TEST(Prediction, TheReferencesPathIsNotTakenWhereAGroupSharesAMap) {
  const pack::Contents pack = lights_in_a_box(20, 6);
  World world(pack::view_of(pack));
  Predictor predictor(world);
  RenderSettings settings = clustered(DistanceScaling::grow);
  settings.recipe.d_init_m = 0.0f;
  EXPECT_EQ(predictor.plan(settings).stats.reference_path, 1u);
  for (const LightId id : {3u, 17u}) {
    pack::Light light = world.lights()[id];
    light.group = 1;
    world.set_light(id, light);
  }
  const FrameStats stats = predictor.plan(settings).stats;
  EXPECT_EQ(stats.reference_path, 0u);
  EXPECT_EQ(stats.shadow_maps, 19u);
  EXPECT_EQ(stats.centers[3], stats.centers[17]);
}

// Nor where a light is held at another's map: it would lose that.
TEST(Prediction, TheReferencesPathKeepsHeldCenters) {
  const pack::Contents pack = lights_in_a_box(20, 6);
  const World world(pack::view_of(pack));
  Predictor predictor(world);
  RenderSettings settings = clustered(DistanceScaling::grow);
  settings.recipe.d_init_m = 0.0f;
  settings.centers.assign(20, pack::none);
  settings.centers[3] = 17;
  const Prediction held = predictor.plan(settings);
  EXPECT_EQ(held.stats.shadow_maps, 19u);
  EXPECT_EQ(held.stats.centers[3], 17u);
  EXPECT_EQ(held.stats.reference_path, 0u);
  EXPECT_EQ(held.plan.recipe.filter, Filter::pcf);  // a shared map needs it

  settings.centers[3] = 3;
  EXPECT_EQ(predictor.plan(settings).stats.reference_path, 1u);  // which is where the reference has it too
}

// It is hard; a light with a radius, in view or not, keeps the filter that was asked for.
TEST(Prediction, TheReferencesPathKeepsLightsWithARadiusSoft) {
  const pack::Contents pack = lights_in_a_box(20, 6);
  World world(pack::view_of(pack));
  Predictor predictor(world);
  RenderSettings settings = clustered(DistanceScaling::grow);
  settings.recipe.d_init_m = 0.0f;
  settings.recipe.filter = Filter::pcss;
  EXPECT_EQ(predictor.plan(settings).plan.recipe.filter, Filter::hard);
  pack::Light light = world.lights()[3];
  light.radius_m = 0.05f;
  for (const float away_m : {0.0f, 1e4f}) {
    light.position_ws.z += away_m;
    world.set_light(3, light);
    const Prediction soft = predictor.plan(settings);
    EXPECT_EQ(soft.stats.reference_path, 1u);
    EXPECT_EQ(soft.plan.recipe.filter, Filter::pcss);
    EXPECT_EQ(soft.plan.recipe.select, Select::per_light);
  }
  light.shadowless = 1;
  world.set_light(3, light);
  EXPECT_EQ(predictor.plan(settings).plan.recipe.filter, Filter::hard);
}

// What sharing a map adds to it is.
TEST(Prediction, ARadiusThatItsAuthorGaveIsNoError) {
  pack::Contents pack = posts_on_a_floor();
  const pack::View view = pack::view_of(pack);
  const World world(view);
  Predictor predictor(world);
  RenderSettings settings = small_picture();
  settings.recipe.filter = Filter::pcss;
  settings.recipe.select = Select::per_light;
  const double hard = predictor.expected_rmse(settings, predictor.plan(settings).plan);
  settings.recipe.select = Select::light_clusters;
  settings.recipe.d_init_m = 1.7f;
  const double shared = predictor.expected_rmse(settings, predictor.plan(settings).plan);
  for (pack::Light& light : pack.lights) light.radius_m = 0.2f;
  EXPECT_GT(predictor.expected_rmse(settings, predictor.plan(settings).plan), 0.5 * shared);
  settings.recipe.select = Select::per_light;
  EXPECT_EQ(predictor.expected_rmse(settings, predictor.plan(settings).plan), hard);
  EXPECT_GT(shared, 2 * hard);
}

TEST(Prediction, RefusesAnswersThatItDoesNotKnow) {
  const pack::Contents pack = lights_in_a_box(4, 5);
  const World world(pack::view_of(pack));
  Predictor predictor(world);
  for (size_t stage = 0; stage < stage_choices().size(); ++stage) {
    RenderSettings settings;
    with_answer(settings.recipe, stage,
                [](auto& value) { value = static_cast<std::remove_reference_t<decltype(value)>>(77); });
    try {
      predictor.predict(settings);
      FAIL() << "a predictor takes an answer that it does not know";
    } catch (const std::invalid_argument& error) {
      EXPECT_EQ(error.what(), std::string(stage_choices()[stage].stage) + ": there is no answer of number 77");
    }
  }
  EXPECT_THROW(count_casters(static_cast<Cull>(77), {}, {}, 1, world), std::invalid_argument);
}

TEST(Prediction, CountsLightsMapsAndViews) {
  const pack::Contents pack = lights_in_a_box(40, 5);
  const pack::View view = pack::view_of(pack);
  const World world(view);
  Predictor predictor(world);
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
