// SPDX-License-Identifier: Apache-2.0
// The C interface of the preview: the runtime's own selection of the same lights, and an error for everything else.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <functional>
#include <random>
#include <string>

#include "light_range.h"
#include "predict/d_init_search.h"
#include "preview/chandelier_preview.h"

namespace chandelier {
namespace {

struct Random {
  uint32_t any() { return static_cast<uint32_t>(bits()); }
  explicit Random(uint32_t seed) : bits(seed) {}
  uint32_t below(uint32_t count) { return static_cast<uint32_t>(bits() % count); }
  bool once_in(uint32_t count) { return below(count) == 0; }
  float uniform(float from, float to) { return from + (to - from) * static_cast<float>(bits() >> 8) * 0x1p-24f; }

  std::mt19937 bits;
};

struct Record {
  std::array<float, 3> position{};
  uint8_t type = 0;
  std::array<float, 3> direction{0.0f, -1.0f, 0.0f};
  float intensity = 1.0f;
  std::array<float, 3> color{1.0f, 1.0f, 1.0f};
  float range_m = 0.0f;
  uint8_t flags = 0;
  float spot_outer_rad = 0.5f;
  uint8_t priority = 128;
  int32_t group = -1;
};

// What a call takes and gives. Its columns are parts of records that lie one after the other, with a byte between.
struct Call {
  static constexpr size_t stride = sizeof(Record) + 1;

  explicit Call(std::vector<Record> given) : records(std::move(given)), bytes(1 + records.size() * stride) {
    const auto count = static_cast<uint32_t>(records.size());
    const auto column = [&](size_t offset) -> ChandelierPreviewColumn { return {bytes.data() + 1 + offset, stride}; };
    lights = {.struct_bytes = sizeof lights,
              .count = count,
              .position = column(offsetof(Record, position)),
              .direction = column(offsetof(Record, direction)),
              .type = column(offsetof(Record, type)),
              .intensity = column(offsetof(Record, intensity)),
              .color = column(offsetof(Record, color)),
              .range_m = column(offsetof(Record, range_m)),
              .spot_outer_rad = column(offsetof(Record, spot_outer_rad)),
              .flags = column(offsetof(Record, flags)),
              .priority = column(offsetof(Record, priority)),
              .group = column(offsetof(Record, group))};
    chandelier_preview_defaults(&settings);
    camera = {.struct_bytes = sizeof camera,
              .eye_ws = {0, 0, 12},
              .forward_ws = {0, 0, -1},
              .up_ws = {0, 1, 0},
              .yfov_rad = 1.0f,
              .znear_m = 0.05f,
              .width_px = 1280,
              .height_px = 720};
    centers.assign(count, 77);
    ranges.assign(count, -1.0f);
    over_budget.assign(count, 77);
    clusters.assign(count, {});
    result = {.struct_bytes = sizeof result,
              .capacity = count,
              .center_of_light = centers.data(),
              .range_of_light_m = ranges.data(),
              .over_budget_of_light = over_budget.data(),
              .clusters = clusters.data()};
  }
  Call(const Call&) = delete;

  int32_t select() {
    for (size_t i = 0; i < records.size(); ++i) std::memcpy(bytes.data() + 1 + i * stride, &records[i], sizeof(Record));
    std::array<char, 256> text{};
    const int32_t status = chandelier_preview_select(&lights, &settings, &camera, &result, text.data(), text.size());
    error = text.data();
    return status;
  }

  std::vector<Record> records;
  std::vector<char> bytes;
  ChandelierPreviewLights lights{};
  ChandelierPreviewSettings settings{};
  ChandelierPreviewCamera camera{};
  ChandelierPreviewResult result{};
  std::vector<uint32_t> centers;
  std::vector<float> ranges;
  std::vector<uint8_t> over_budget;
  std::vector<ChandelierPreviewCluster> clusters;
  std::string error;
};

std::vector<Record> random_lights(Random& random, uint32_t count) {
  std::vector<Record> records(count);
  for (Record& record : records) {
    record.position = {random.uniform(-6, 6), random.uniform(-2, 2), random.uniform(-6, 6)};
    record.type = static_cast<uint8_t>(random.once_in(8) ? 2 : random.below(2));
    const glm::vec3 way = glm::normalize(
        glm::vec3(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)) + glm::vec3(0, 0, 1e-3f));
    record.direction = {way.x, way.y, way.z};
    record.intensity = random.once_in(20) ? 0.0f : random.uniform(0.1f, 3.0f);
    record.color = {random.uniform(0, 1), random.uniform(0.1f, 1), random.uniform(0, 1)};
    record.range_m = random.once_in(2) ? 0.0f : random.uniform(1, 8);
    record.spot_outer_rad = random.uniform(0.05f, 1.57f);
    record.flags = static_cast<uint8_t>(random.once_in(4) ? random.below(4) : 0);
    record.priority = static_cast<uint8_t>(random.once_in(3) ? random.below(256) : 128);
    record.group = random.once_in(5) ? static_cast<int32_t>(random.below(3)) : -1;
  }
  return records;
}

void random_settings(Random& random, Call& call) {
  call.settings.select = random.once_in(6) ? 0 : 1;
  call.settings.distance_scaling = random.below(3);
  call.settings.dynamic_lights = random.below(2);
  call.settings.face_size_px = 64u << random.below(4);
  call.settings.d_init_m = random.once_in(5) ? 0.0f : std::exp2(random.uniform(-3, 3));
  call.settings.z_far_m = random.uniform(5, 60);
  call.settings.max_shadow_maps = random.once_in(2) ? 0 : 1 + random.below(30);
  if (random.once_in(3)) call.settings.max_shadow_bytes = (1 + random.below(40)) * uint64_t{1} << 20;
  call.camera.sees_all = random.once_in(4);
  for (float& part : call.camera.eye_ws) part = random.uniform(-8, 8);
}

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
    Predictor predictor(expected.view);
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
    EXPECT_EQ(members, call.result.bill.lights_in_view);
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

struct Misuse {
  const char* name;
  std::function<void(Call&)> commit;
  const char* error;
};
void PrintTo(const Misuse& misuse, std::ostream* out) {
  *out << misuse.name;
}

constexpr float nan_ = std::numeric_limits<float>::quiet_NaN(), inf_ = std::numeric_limits<float>::infinity();

const Misuse misuses[]{
    {"PlaceNan", [](Call& c) { c.records[1].position[2] = nan_; },
     "light 1, position: is not from -1e+12 to 1e+12 (nan)"},
    {"PlaceInfinite", [](Call& c) { c.records[0].position[0] = -inf_; },
     "light 0, position: is not from -1e+12 to 1e+12 (-inf)"},
    {"RangeNegative", [](Call& c) { c.records[1].range_m = -3; },
     "light 1, range_m: is not from 0 to 3.4028235e+38 (-3)"},
    {"IntensityNegative", [](Call& c) { c.records[1].intensity = -1; },
     "light 1, intensity: is not from 0 to 1e+12 (-1)"},
    {"ColorNan", [](Call& c) { c.records[0].color[1] = nan_; }, "light 0, color: is not from 0 to 1e+06 (nan)"},
    {"Type", [](Call& c) { c.records[0].type = 3; }, "light 0, type: is none of 0, 1 and 2 (3)"},
    {"NoDirection", [](Call& c) { c.records[1].direction = {}; }, "light 1, direction: has no direction (0)"},
    {"DirectionNan", [](Call& c) { c.records[1].direction[0] = nan_; }, "light 1, direction: has no direction (nan)"},
    {"WideCone", [](Call& c) { c.records[1].spot_outer_rad = 1.6f; },
     "light 1, spot_outer_rad: is not from 1e-06 to 1.5707964 (1.6)"},
    {"HugeCount", [](Call& c) { c.lights.count = 0xFFFFFFFF; }, "result: capacity is below the number of lights"},
    {"HugeCountAndCapacity", [](Call& c) { c.lights.count = c.result.capacity = 0xFFFFFFFF; },
     "lights: count is above 1048576 (4294967295)"},
    {"NoPlaces", [](Call& c) { c.lights.position = {}; }, "position: is missing"},
    {"ShortStride", [](Call& c) { c.lights.position.stride_bytes = 11; },
     "position: stride_bytes is neither 0 nor from 12 to 2^31 (11)"},
    {"NegativeStride", [](Call& c) { c.lights.group.stride_bytes = -4; },
     "group: stride_bytes is neither 0 nor from 4 to 2^31 (-4)"},
    {"WideStride", [](Call& c) { c.lights.flags.stride_bytes = INT64_MAX; },
     "flags: stride_bytes is neither 0 nor from 1 to 2^31"},
    {"Capacity", [](Call& c) { c.result.capacity = 1; }, "result: capacity is below the number of lights (1 for 2)"},
    {"SizeOfLights", [](Call& c) { c.lights.struct_bytes = 8; }, "lights: struct_bytes is not "},
    {"SizeOfSettings", [](Call& c) { c.settings.struct_bytes = 0; }, "settings: struct_bytes is not "},
    {"SizeOfCamera", [](Call& c) { ++c.camera.struct_bytes; }, "camera: struct_bytes is not "},
    {"SizeOfResult", [](Call& c) { --c.result.struct_bytes; }, "result: struct_bytes is not "},
    {"Select", [](Call& c) { c.settings.select = 2; }, "select: is above 1 (2)"},
    {"Filter", [](Call& c) { c.settings.filter = 3; }, "filter: is above 2 (3)"},
    {"Scaling", [](Call& c) { c.settings.distance_scaling = 3; }, "distance_scaling: is above 2 (3)"},
    {"Dynamic", [](Call& c) { c.settings.dynamic_lights = 2; }, "dynamic_lights: is above 1 (2)"},
    {"DInitNan", [](Call& c) { c.settings.d_init_m = nan_; }, "d-init must be a distance of 0 m or more"},
    {"DInitNegative", [](Call& c) { c.settings.d_init_m = -1; }, "d-init must be a distance of 0 m or more"},
    {"ZFar", [](Call& c) { c.settings.z_far_m = 0; }, "z-far must be a distance above 0 m"},
    {"FaceSize", [](Call& c) { c.settings.face_size_px = 0; }, "face-size must be from 16 to 16384 texels"},
    {"ReferenceShare", [](Call& c) { c.settings.reference_share = nan_; }, "reference-share must be above 0"},
    {"Threshold", [](Call& c) { c.settings.range_threshold_lx = 0; }, "range_threshold_lx: is not above 0 (0)"},
    {"HardClusters", [](Call& c) { c.settings.filter = 0; }, "select light-clusters with filter hard"},
    {"Eye", [](Call& c) { c.camera.eye_ws[1] = inf_; }, "camera, eye_ws: is out of range (inf)"},
    {"Forward", [](Call& c) { c.camera.forward_ws[2] = 0; }, "camera, forward_ws: has no direction (0)"},
    {"Up", [](Call& c) { c.camera.up_ws[0] = nan_; }, "camera, up_ws: has no direction (nan)"},
    {"Angle", [](Call& c) { c.camera.yfov_rad = 3.2f; }, "camera, yfov_rad: is not from 0.0001 to 3.1 (3.2"},
    {"Near", [](Call& c) { c.camera.znear_m = 0; }, "camera, znear_m: is not above 0 (0)"},
    {"Size", [](Call& c) { c.camera.height_px = 0; }, "camera, width_px and height_px: is not from 1 to 65536 (0)"},
};

class PreviewMisuse : public testing::TestWithParam<Misuse> {};

TEST_P(PreviewMisuse, IsNamedInOneLine) {
  Call call({Record{}, Record{.type = 1}});
  ASSERT_EQ(call.select(), CHANDELIER_PREVIEW_OK) << call.error;
  GetParam().commit(call);
  EXPECT_EQ(call.select(), CHANDELIER_PREVIEW_BAD_INPUT);
  EXPECT_EQ(call.error.substr(0, std::strlen(GetParam().error)), GetParam().error);
  EXPECT_EQ(call.error.find('\n'), std::string::npos);
}

INSTANTIATE_TEST_SUITE_P(Each, PreviewMisuse, testing::ValuesIn(misuses),
                         [](const testing::TestParamInfo<Misuse>& each) { return each.param.name; });

TEST(PreviewTest, NullsAreNamedAndErrorTextIsCut) {
  Call call({Record{}});
  std::array<char, 8> text;
  text.fill('x');
  EXPECT_EQ(chandelier_preview_select(nullptr, &call.settings, &call.camera, &call.result, text.data(), 6),
            CHANDELIER_PREVIEW_BAD_INPUT);
  EXPECT_STREQ(text.data(), "light");
  EXPECT_EQ(text[6], 'x');
  EXPECT_EQ(chandelier_preview_select(&call.lights, nullptr, &call.camera, &call.result, nullptr, 99),
            CHANDELIER_PREVIEW_BAD_INPUT);
  EXPECT_EQ(chandelier_preview_select(&call.lights, &call.settings, nullptr, &call.result, text.data(), 0),
            CHANDELIER_PREVIEW_BAD_INPUT);
  EXPECT_EQ(chandelier_preview_select(&call.lights, &call.settings, &call.camera, nullptr, text.data(), 8),
            CHANDELIER_PREVIEW_BAD_INPUT);
  EXPECT_EQ(chandelier_preview_select(&call.lights, &call.settings, &call.camera, &call.result, text.data(), 8),
            CHANDELIER_PREVIEW_OK);
  EXPECT_STREQ(text.data(), "");
  chandelier_preview_defaults(nullptr);
  EXPECT_EQ(chandelier_preview_abi(), CHANDELIER_PREVIEW_ABI);
}

// Bits anywhere, but where the memory is: nothing but an answer or an error comes back. Under sanitizers this looks for
// what must not happen on the way.
TEST(PreviewTest, WhateverTheNumbersAreItAnswersOrNamesThem) {
  uint32_t answered = 0, named = 0;
  for (uint32_t seed = 0; seed < 20000; ++seed) {
    Random random(seed);
    Call call(random_lights(random, random.below(12)));
    random_settings(random, call);
    const ChandelierPreviewLights places = call.lights;
    const auto scramble = [&](void* at, size_t bytes) {
      static constexpr std::array<uint32_t, 8> hostile{0,           0x7FC00000, 0x7F800000, 0xFF800000,
                                                       0x7F7FFFFFu, 0x00000001, 0x80000000, 0xFFFFFFFF};
      const size_t offset = 4 * random.below(static_cast<uint32_t>(bytes / 4));
      const uint32_t value = random.once_in(2) ? hostile[random.below(8)] : random.any();
      std::memcpy(static_cast<char*>(at) + offset, &value, 4);
    };
    for (uint32_t i = random.below(3); i > 0; --i) {
      const uint32_t where = random.below(4);
      if (where == 0 && !call.records.empty())
        scramble(call.records.data(), call.records.size() * sizeof(Record));
      else if (where == 1)
        scramble(&call.settings, sizeof call.settings);
      else if (where == 2)
        scramble(&call.camera, sizeof call.camera);
      else
        call.lights.count = random.below(2) ? places.count : random.any();
    }
    if (call.lights.count > places.count) call.result.capacity = call.lights.count;
    const bool beyond = call.lights.count > places.count;
    if (beyond && call.lights.count <= CHANDELIER_PREVIEW_MOST_LIGHTS) continue;  // would read what is not there
    const int32_t status = call.select();
    ASSERT_TRUE(status == CHANDELIER_PREVIEW_OK || status == CHANDELIER_PREVIEW_BAD_INPUT) << seed << call.error;
    ASSERT_EQ(status == CHANDELIER_PREVIEW_OK, call.error.empty()) << seed;
    (status == CHANDELIER_PREVIEW_OK ? answered : named) += 1;
    if (status != CHANDELIER_PREVIEW_OK) continue;
    for (uint32_t i = 0; i < call.lights.count; ++i) {
      const uint32_t center = call.centers[i];
      ASSERT_TRUE(center == CHANDELIER_PREVIEW_NONE || (center < call.lights.count && call.centers[center] == center));
    }
  }
  EXPECT_GT(answered, 5000u);
  EXPECT_GT(named, 2000u);
}

}  // namespace
}  // namespace chandelier
