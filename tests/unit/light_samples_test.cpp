// SPDX-License-Identifier: Apache-2.0
// What selection by error knows of a picture: what samples see, mean materials, and the curve by which it is shown.
#include <gtest/gtest.h>

#include <cmath>

#include "lights/shown_curve.h"
#include "sampled_scene.h"

namespace chandelier {
namespace {

using test::divided_floor;
using test::Sampled;

TEST(LightSamplesTest, PointsAreLitFromTheirSideOfTheWallAlone) {
  const Sampled s(divided_floor());
  uint32_t left = 0, right = 0;
  for (uint32_t p = 0; p < s.samples->points().size(); ++p) {
    const glm::vec3 at = s.samples->points()[p].position_ws;
    if (at.y > 0.1f) continue;  // the wall's top
    EXPECT_NEAR(glm::distance(s.samples->points()[p].normal_ws, glm::vec3(0, 1, 0)), 0.0f, 1e-5f);
    for (uint32_t light = 0; light < 4; ++light) EXPECT_EQ(s.samples->sees(light, p), (light < 2) == (at.x < 0));
    (at.x < 0 ? left : right) += 1;
  }
  EXPECT_GT(left, 500u);
  EXPECT_GT(right, 500u);
}

// As the lamp's shadow map has it, whose near plane lies before what is nearest to it.
TEST(LightSamplesTest, WhatHangsCloseToALampShadowsWhatIsFarBehind) {
  test::Scene scene;
  const uint32_t white = scene.add_material(test::plain_material(glm::vec3(0.5f)));
  scene.add(test::level_square(glm::vec3(0, 2.001f, 0), 4), white);
  pack::Light lamp = test::point_light({0, 2, 0}, 10, 20);
  lamp.nearest_caster_m = 0.001f;
  scene.lights.push_back(lamp);
  const Sampled s(scene);
  for (const float x : {0.0f, 0.1f, 1.0f, 5.0f}) {
    EXPECT_FALSE(sees(s.rays, lamp, {x, 7, 0})) << x;
    EXPECT_TRUE(sees(s.rays, lamp, {x, -3, 0})) << x;
  }
}

// As it is drawn: a room's ceiling does not hide the room from above, but where its material has two sides.
TEST(LightSamplesTest, BacksHideNothing) {
  for (const bool double_sided : {false, true}) {
    test::Scene scene;
    pack::Material material = test::plain_material(glm::vec3(0.5f));
    scene.add(test::level_square(glm::vec3(0), 4), scene.add_material(material));
    material.double_sided = double_sided ? 1 : 0;
    scene.add(test::quad({0, 4, 0}, {4, 0, 0}, {0, 0, 4}), scene.add_material(material));  // its front looks down
    scene.lights.push_back(test::point_light({0, 2, 0}, 10, 8));
    const Sampled s(scene);
    ASSERT_GT(s.samples->points().size(), 1000u);
    for (const auto& point : s.samples->points()) EXPECT_NEAR(point.position_ws.y, double_sided ? 4.0f : 0.0f, 0.01f);
    EXPECT_EQ(s.samples->contributions(0).empty(), double_sided);
  }
}

// What a light adds is what shading/brdf.glsl says: rough white paint, straight below the light.
TEST(LightSamplesTest, AddsWhatTheShaderAdds) {
  test::Scene scene;
  scene.add(test::level_square(glm::vec3(0), 4), scene.add_material(test::plain_material(glm::vec3(0.5f))));
  scene.lights.push_back(test::point_light({0, 2, 0}, 10, 4));
  const Sampled s(scene);
  float nearest = INFINITY, luminance = 0.0f;
  for (const auto& contribution : s.samples->contributions(0)) {
    const float away = glm::length(glm::vec2(s.samples->points()[contribution.point].position_ws.x,
                                             s.samples->points()[contribution.point].position_ws.z));
    if (away >= nearest) continue;
    nearest = away;
    luminance = contribution.radiance.x;
  }
  ASSERT_LT(nearest, 0.1f);
  // Illuminance 10 / 4 * (1 - 1/16); Fresnel 0.04 off the diffuse part; the microfacet layer D V F = 1/pi * 1/4 * 0.04.
  const float expected = 2.5f * 15.0f / 16.0f * (0.96f * 0.5f + 0.04f * 0.25f) / 3.14159265f;
  EXPECT_NEAR(luminance / std::exp2(s.samples->exposure_ev()) / expected, 1.0f, 0.01f);
}

// A floor and a ceiling, each lit from its side alone: what the g-buffer pass adds there.
TEST(LightSamplesTest, AmbientLightIsThatOfTheNormal) {
  test::Scene scene;
  const uint32_t paint = scene.add_material(test::plain_material({0.5f, 0.25f, 1.0f}));
  scene.add(test::level_square(glm::vec3(0), 4), paint);
  scene.add(test::quad({0, 4, 0}, {4, 0, 0}, {0, 0, 4}), paint);  // its front looks down
  const pack::File pack = scene.open();
  const rays::PackRays rays(pack.view());
  const SampledScene sampled(pack.view(), rays);
  const Camera camera{.eye_ws = {0, 2, 3.9f}, .yfov_rad = 1.5f};
  const SampleSettings settings{.ambient = Ambient::between(3.0f, 0.5f), .exposure_ev = 0.0f};
  const LightSamples samples(sampled, {}, camera, 1.0f, settings);
  uint32_t floor = 0, ceiling = 0;
  for (const auto& point : samples.points()) {
    const bool is_floor = point.position_ws.y < 2.0f;
    (is_floor ? floor : ceiling) += 1;
    const float expected = 1.75f + (is_floor ? 1.0f : -1.0f) * 2.0f / 3.0f * 1.25f;
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(point.unshadowable[c], expected * glm::vec3(0.5f, 0.25f, 1.0f)[c], 1e-6f);
    EXPECT_EQ(point.unshadowable, point.reference);
  }
  EXPECT_GT(floor, 100u);
  EXPECT_GT(ceiling, 100u);
}

TEST(ShownCurveTest, TableAndFormulaAgree) {
  const ShownCurve table;
  for (float x = 0.0f; x < 40.0f; x = x * 1.01f + 1e-4f) EXPECT_NEAR(table(x), shown(x), 3e-4f) << x;
  EXPECT_EQ(shown(0.0f), 0.0f);
  EXPECT_NEAR(shown(1e9f), 1.0f, 1e-6f);
  // Narkowicz's curve at 0.18: 0.0869 / 0.3249, by sRGB.
  EXPECT_NEAR(shown(0.18f), 1.055f * std::pow(0.086724f / 0.324932f, 1.0f / 2.4f) - 0.055f, 1e-4f);
}

TEST(MeanMaterialTest, TexturesCountByTheirMean) {
  test::Scene scene;
  pack::Material material = test::plain_material({1.0f, 0.5f, 1.0f});
  material.base_color_texture = scene.add_texture(2, 1, {0xFF000000u, 0xFFFF80FFu});
  scene.add(test::level_square(glm::vec3(0), 1), scene.add_material(material));
  // BC1: both ends of a red ramp and the two colours between, a quarter of the texels each.
  pack::Image bc1{.width = 4, .height = 4, .level_count = 1, .format = pack::ImageFormat::bc1_unorm};
  const std::array<uint8_t, 8> block{0x00, 0xF8, 0x00, 0x00, 0b11100100, 0b11100100, 0b11100100, 0b11100100};
  material.base_color_texture = scene.add_texture(bc1, std::as_bytes(std::span(block)));
  scene.add(test::level_square(glm::vec3(0), 1), scene.add_material(material));
  // BC5: red all eight values from 1 to 0 twice, green the block's first value alone; there is no blue.
  pack::Image bc5{.width = 4, .height = 4, .level_count = 1, .format = pack::ImageFormat::bc5_unorm};
  const std::array<uint8_t, 16> blocks{255, 0, 0x88, 0xC6, 0xFA, 0x88, 0xC6, 0xFA, 51, 51, 0, 0, 0, 0, 0, 0};
  material.base_color_texture = scene.add_texture(bc5, std::as_bytes(std::span(blocks)));
  scene.add(test::level_square(glm::vec3(0), 1), scene.add_material(material));
  // Half floats: of the emissive colour all counts, of a lit base colour at most 1.
  const pack::Image half{.width = 1, .height = 1, .level_count = 1, .format = pack::ImageFormat::rgba16_sfloat};
  const std::array<uint16_t, 4> texel{0x4400, 0x3400, 0x5640, 0};  // 4, 1/4, 100, 0
  material.base_color_texture = material.emissive_texture = scene.add_texture(half, std::as_bytes(std::span(texel)));
  material.emissive = glm::vec3(2.0f);
  scene.add(test::level_square(glm::vec3(0), 1), scene.add_material(material));
  material.unlit = 1;
  scene.add(test::level_square(glm::vec3(0), 1), scene.add_material(material));
  // An image that is stored with a codec: two levels, of which the smaller one counts.
  std::vector<uint32_t> texels(64 * 64 + 32 * 32, 0xFF00FF00u);
  std::fill(texels.begin() + 64 * 64, texels.end(), 0xFFFF0000u);
  const pack::Image large{.width = 64, .height = 64, .level_count = 2, .format = pack::ImageFormat::rgba8_unorm};
  material.base_color_texture = scene.add_texture(large, std::as_bytes(std::span(texels)));
  scene.add(test::level_square(glm::vec3(0), 1), scene.add_material(material));
  const pack::File pack = scene.open(pack::Compression::smallest);
  EXPECT_EQ(pack.view().images.back().codec, pack::ImageCodec::zstd);
  const auto means = mean_materials(pack.view());
  ASSERT_EQ(means.size(), 6u);
  EXPECT_EQ(means[5].base_color, glm::vec3(0.0f, 0.0f, 1.0f));
  EXPECT_NEAR(glm::distance(means[2].base_color, {0.5f, 0.1f, 0.0f}), 0.0f, 1e-6f);
  EXPECT_EQ(means[3].base_color, glm::vec3(1.0f, 0.125f, 1.0f));
  EXPECT_EQ(means[3].emissive, glm::vec3(8.0f, 0.5f, 200.0f));
  EXPECT_EQ(means[4].base_color, glm::vec3(4.0f, 0.125f, 100.0f));
  EXPECT_NEAR(glm::distance(means[0].base_color, {0.5f, 0.5f * 128 / 255 / 2, 0.5f}), 0.0f, 1e-3f);
  EXPECT_NEAR(glm::distance(means[1].base_color, {0.5f, 0.0f, 0.0f}), 0.0f, 1e-3f);
}

}  // namespace
}  // namespace chandelier
