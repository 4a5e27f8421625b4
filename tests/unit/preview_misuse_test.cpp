// SPDX-License-Identifier: Apache-2.0
// Whatever the preview's C interface is handed, it answers or says in one line what is wrong.
#include <gtest/gtest.h>

#include <functional>
#include <limits>

#include "preview_call.h"

namespace chandelier {
namespace {

using namespace test;

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
    {"DInitNan", [](Call& c) { c.settings.d_init_m = nan_; }, "d-init must be from 0 to 1000000 m"},
    {"DInitNegative", [](Call& c) { c.settings.d_init_m = -1; }, "d-init must be from 0 to 1000000 m"},
    {"ZFar", [](Call& c) { c.settings.z_far_m = 0; }, "z-far must be from 0.001 to 1000000 m"},
    {"FaceSize", [](Call& c) { c.settings.face_size_px = 0; }, "face-size must be from 16 to 16384 texels"},
    {"ReferenceShare", [](Call& c) { c.settings.reference_share = nan_; },
     "reference-share must be from 0.001 to 1000000"},
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
