// SPDX-License-Identifier: Apache-2.0
// The C interface of the preview makes the runtime's own selection of the same lights.
#include <gtest/gtest.h>

#include "light_range.h"
#include "predict/d_init_search.h"
#include "preview_call.h"

namespace chandelier {
namespace {

using namespace test;

// The same by the runtime's own types, as a pack of these lights would have it.
struct Expected {
  explicit Expected(const Call& call) {
    for (uint32_t i = 0; i < call.records.size(); ++i) {
      const Record& record = call.records[i];
      if (record.intensity == 0.0f) continue;
      numbers.push_back(i);
      pack::Light light;
      light.type = static_cast<pack::LightType>(record.type);
      light.intensity = record.intensity;
      light.color = {record.color[0], record.color[1], record.color[2]};
      light.direction_ws = {record.direction[0], record.direction[1], record.direction[2]};
      if (record.type != 2) {
        light.position_ws = {record.position[0], record.position[1], record.position[2]};
        light.range_m =
            record.range_m > 0.0f ? float{record.range_m} : pack::derived_range_m(record.intensity, light.color, 0.05f);
      }
      light.inner_cone_cos = 1.0f;
      light.outer_cone_cos = record.type == 1 ? std::cos(record.spot_outer_rad) : -1.0f;
      light.dynamic = record.flags & 1;
      light.unclustered = record.flags >> 1 & 1;
      light.shadowless = record.flags >> 2 & 1;
      light.radius_m = record.radius_m;
      light.priority = record.priority;
      light.group = static_cast<uint32_t>(record.group + 1);
      lights.push_back(light);
    }
    settings.recipe.select = static_cast<Select>(call.settings.select);
    settings.recipe.filter = Filter::pcss;
    settings.recipe.distance_scaling = static_cast<DistanceScaling>(call.settings.distance_scaling);
    settings.recipe.dynamic_lights = static_cast<DynamicLights>(call.settings.dynamic_lights);
    settings.recipe.face_size_px = call.settings.face_size_px;
    settings.recipe.d_init_m = call.settings.d_init_m;
    settings.recipe.z_far_m = call.settings.z_far_m;
    settings.camera.eye_ws = {call.camera.eye_ws[0], call.camera.eye_ws[1], call.camera.eye_ws[2]};
    settings.lights_out_of_view = call.camera.sees_all != 0;
    view.lights = lights;
  }

  std::vector<pack::Light> lights;
  std::vector<uint32_t> numbers;
  RenderSettings settings;
  pack::View view;
};

void expect_counters(const ChandelierPreviewBill& bill, const FrameStats& stats) {
  EXPECT_EQ(bill.lights, stats.lights);
  EXPECT_EQ(bill.lights_in_view, stats.lights_in_view);
  EXPECT_EQ(bill.shadowless_in_view, stats.shadowless_in_view);
  EXPECT_EQ(bill.shadow_maps, stats.shadow_maps);
  EXPECT_EQ(bill.shadow_views, stats.shadow_views);
  EXPECT_EQ(bill.shadow_bytes, stats.shadow_bytes);
  EXPECT_EQ(bill.reference_path, stats.reference_path);
}

TEST(PreviewTest, SelectsWhatAFrameOfTheSameLightsWould) {
  uint32_t over_budget = 0, out_of_view = 0, shared = 0;
  for (uint32_t seed = 0; seed < 400 && !HasFailure(); ++seed) {
    SCOPED_TRACE(seed);
    Random random(seed);
    Call call(random_lights(random, random.below(60)));
    random_settings(random, call);
    ASSERT_EQ(call.select(), CHANDELIER_PREVIEW_OK) << call.error;
    Expected expected(call);
    const World world(expected.view);
    Predictor predictor(world);
    const Prediction wanted = predictor.plan(expected.settings);
    const Budget budget{
        .max_shadow_maps =
            call.settings.max_shadow_maps != 0 ? std::optional(call.settings.max_shadow_maps) : std::nullopt,
        .max_shadow_bytes =
            call.settings.max_shadow_bytes != 0 ? std::optional(call.settings.max_shadow_bytes) : std::nullopt};
    BudgetedPlan plan{.recipe = expected.settings.recipe, .prediction = wanted};
    if (!keeps(wanted.stats, budget) && call.settings.select == 1)
      plan = choose_d_init(predictor, expected.settings, budget);
    expect_counters(call.result.bill, plan.prediction.stats);
    EXPECT_EQ(call.result.bill.d_init_m, plan.recipe.d_init_m);
    EXPECT_EQ(call.result.bill.over_budget, !keeps(wanted.stats, budget));
    for (uint32_t i = 0; i < expected.lights.size(); ++i) {
      const uint32_t center = plan.prediction.stats.centers[i], at = expected.numbers[i];
      EXPECT_EQ(call.centers[at], center == pack::none ? CHANDELIER_PREVIEW_NONE : expected.numbers[center]);
      EXPECT_EQ(call.over_budget[at], wanted.stats.centers[i] == i && center != i);
      EXPECT_EQ(call.ranges[at], expected.lights[i].range_m);
      over_budget += call.over_budget[at];
      out_of_view += center == pack::none;
      shared += center != pack::none && center != i;
    }
    uint32_t members = 0;
    for (const ChandelierPreviewCluster& cluster : std::span(call.clusters).first(call.result.cluster_count)) {
      EXPECT_EQ(call.centers[cluster.center], cluster.center);
      members += cluster.light_count;
    }
    EXPECT_EQ(members, call.result.bill.lights_in_view - call.result.bill.shadowless_in_view);
  }
  EXPECT_GT(over_budget, 500u);
  EXPECT_GT(out_of_view, 500u);
  EXPECT_GT(shared, 1000u);
}

TEST(PreviewTest, ClustersAreAsLightClusterSays) {
  Call call({Record{.position = {0, 0, 0}, .range_m = 4}, Record{.position = {0.5f, 0, 0}, .range_m = 3},
             Record{.position = {5, 0, 0}, .range_m = 1}, Record{.type = 2, .direction = {0, -3, 0}}});
  call.settings.d_init_m = 1.0f;
  call.settings.reference_share = 2.0f;
  ASSERT_EQ(call.select(), CHANDELIER_PREVIEW_OK) << call.error;
  EXPECT_EQ(call.centers, (std::vector<uint32_t>{0, 0, 2, 3}));
  ASSERT_EQ(call.result.cluster_count, 3u);
  EXPECT_EQ(call.clusters[0].light_count, 2u);
  EXPECT_FLOAT_EQ(call.clusters[0].d_min_m, 1.0f + 12.0f / 30.0f);
  EXPECT_FLOAT_EQ(call.clusters[0].range_m, 4.0f);
  EXPECT_FLOAT_EQ(call.clusters[0].spread_m, 0.5f);
  EXPECT_FLOAT_EQ(call.clusters[1].d_min_m, 1.0f + 13.0f / 30.0f);
  EXPECT_EQ(call.clusters[2].d_min_m, 1.0f);
  EXPECT_EQ(call.clusters[2].range_m, 0.0f);
  EXPECT_EQ(call.result.bill.shadow_views, 18u);
  EXPECT_EQ(call.result.bill.shadow_bytes, uint64_t{3} * 6 * 4 * 512 * 512);
}

TEST(PreviewTest, ColumnsMayBeAbsentOrOneValueForAll) {
  const std::array<float, 6> positions{0, 0, 0, 0.1f, 0, 0};
  const float range_m = 2.0f;
  Call call({});
  call.lights = {
      .struct_bytes = sizeof call.lights, .count = 2, .position = {positions.data(), 12}, .range_m = {&range_m, 0}};
  call.result = {.struct_bytes = sizeof call.result};  // the bill alone
  ASSERT_EQ(call.select(), CHANDELIER_PREVIEW_OK) << call.error;
  EXPECT_EQ(call.result.bill.lights_in_view, 2u);
  EXPECT_EQ(call.result.bill.shadow_maps, 1u);
  EXPECT_EQ(call.result.cluster_count, 1u);
  call.lights.range_m = {};
  std::vector<float> ranges(2);
  call.result = {.struct_bytes = sizeof call.result, .capacity = 2, .range_of_light_m = ranges.data()};
  ASSERT_EQ(call.select(), CHANDELIER_PREVIEW_OK) << call.error;
  EXPECT_FLOAT_EQ(ranges[1], std::sqrt(1.0f / 0.05f));
}

}  // namespace
}  // namespace chandelier
