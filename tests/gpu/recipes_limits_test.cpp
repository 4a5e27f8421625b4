// SPDX-License-Identifier: Apache-2.0
// What a frame must bear: sizes that change, more lights than fit, nothing to draw; and what it refuses.
#include <cmath>

#include "recipes_test.h"
#include "shadows/store/cube_array.h"

namespace chandelier::test {
namespace {

TEST_F(RecipesTest, SizesMayChangeFromFrameToFrame) {
  const pack::File pack = small_room(6).open();
  const World world(pack);
  Renderer renderer(device(), world);
  RenderSettings settings = room_settings(recipe_with(Select::per_light, Filter::hard, 0));
  const Frame first = frame(renderer, settings);
  settings.width = 61;
  settings.height = 47;
  settings.recipe.face_size_px = 64;
  EXPECT_EQ(frame(renderer, settings).picture.radiance.size(), 61u * 47 * 4);
  settings.width = settings.height = 1;
  EXPECT_EQ(frame(renderer, settings).picture.shown.size(), 4u);
  expect_same(first, frame(renderer, room_settings(recipe_with(Select::per_light, Filter::hard, 0))));
}

TEST_F(RecipesTest, MoreLightsThanACubeArrayHolds) {
  constexpr uint32_t count = 400;
  Scene scene = small_room(0);
  scene.lights.clear();
  for (uint32_t i = 0; i < count; ++i) {
    const float angle = 2.0f * pi * static_cast<float>(i) / count;
    scene.lights.push_back(point_light({3 * std::cos(angle), 2.0f, 2 * std::sin(angle)}, 0.1f, 8.0f));
  }
  Recipe recipe = recipe_with(Select::per_light, Filter::hard, 0);
  recipe.face_size_px = 16;
  const auto settings = settings_for(look({0, 8, 0.1f}, {0, 0, 0}, 1.0f), 64, 64, recipe);
  const pack::File pack = scene.open();
  const World world(pack);
  Renderer renderer(device(), world);
  const Frame all = frame(renderer, settings);
  EXPECT_EQ(all.stats.shadow_maps, count);
  EXPECT_EQ(all.stats.shadow_bytes, count * cube_bytes(16));
  const uint32_t at_a_time = cubes_within(device(), 16, recipe.shadow_budget_bytes);
  EXPECT_GE(all.stats.shadow_rounds, (count + at_a_time - 1) / at_a_time);

  // Light adds up: two halves of the lights give the picture's two halves.
  std::vector<double> sums;
  for (const uint32_t half : {0u, 1u}) {
    Scene part = scene;
    part.lights.assign(scene.lights.begin() + half * count / 2, scene.lights.begin() + (half + 1) * count / 2);
    sums.push_back(brightness(draw(device(), part, settings)));
  }
  EXPECT_NEAR(brightness(all.picture), sums[0] + sums[1], 1e-5 * brightness(all.picture));
}

TEST_F(RecipesTest, StagesAreTimedHoweverManyRoundsThereAre) {
  const pack::File pack = small_room(800).open();
  const World world(pack);
  Renderer renderer(device(), world);
  RenderSettings settings = room_settings(recipe_with(Select::per_light, Filter::hard, 0));
  settings.width = settings.height = 16;
  settings.recipe.face_size_px = 16;
  settings.recipe.shadow_budget_bytes = 1;
  const FrameStats stats = renderer.draw(settings);
  EXPECT_GT(stats.shadow_rounds, 700u);
  EXPECT_EQ(stats.shadow_pool_bytes, cube_bytes(16));
  EXPECT_EQ(stats.stages.back().name, "tone-map");
  EXPECT_GT(stats.stages.back().gpu_ms, 0.0);
}

TEST_F(RecipesTest, WhatIsExposedTooLongIsWhite) {
  const pack::File pack = small_room(5).open();
  const World world(pack);
  Renderer renderer(device(), world);
  RenderSettings settings = room_settings(recipe_with(Select::per_light, Filter::hard, 0));
  settings.exposure_ev = 75.0f;
  const Picture picture = frame(renderer, settings).picture;
  size_t lit = 0;
  for (size_t i = 0; i < picture.radiance.size(); ++i) {
    if (i % 4 == 3 || picture.radiance[i] < 1e-6f) continue;
    ++lit;
    ASSERT_EQ(picture.shown[i], 255) << "channel " << i << ", radiance " << picture.radiance[i];
  }
  EXPECT_GT(lit, 10000u);
}

TEST_F(RecipesTest, NoLightsLeaveBlackAndAmbient) {
  Scene scene = small_room(0);
  scene.lights.clear();
  const pack::File pack = scene.open();
  const World world(pack);
  Renderer renderer(device(), world);
  for (const Preset& preset : presets()) {
    RenderSettings settings = room_settings(preset.recipe);
    settings.exposure_ev.reset();
    const Frame dark = frame(renderer, settings);
    EXPECT_EQ(brightness(dark.picture), 0.0);
    EXPECT_EQ(dark.stats.shadow_maps, 0u);
    settings.ambient = Ambient::constant(0.25f);
    const auto center = radiance_at(frame(renderer, settings).picture, 64, 90);
    EXPECT_NEAR(center.x, 0.125f, 0.001f);  // the floor's 0.5
  }
}

TEST_F(RecipesTest, NoTriangles) {
  Scene scene;
  scene.lights = {point_light({0, 1, 0}, 10, 5), directional_light({0, -1, 0}, 1),
                  spot_light({0, 1, 0}, {0, -1, 0}, 10, 5, 0.1f, 0.2f)};
  const pack::File pack = scene.open();
  const World world(pack);
  Renderer renderer(device(), world);
  for (const Preset& preset : presets()) {
    for (const Cull cull : {Cull::none, Cull::light_frustum}) {
      RenderSettings settings = room_settings(preset.recipe);
      settings.recipe.cull = cull;
      settings.recipe.face_size_px = 64;
      const Frame empty = frame(renderer, settings);
      EXPECT_EQ(brightness(empty.picture), 0.0);
      EXPECT_EQ(empty.stats.shadow_triangles, 0u);
    }
  }
}

TEST_F(RecipesTest, OnlyMaskedSurfaces) {
  Scene scene;
  pack::Material cut = plain_material(glm::vec3(0.5f));
  cut.base_color_texture = scene.add_texture(2, 1, {0xFFFFFFFFu, 0x00FFFFFFu});
  cut.alpha_mode = pack::AlphaMode::mask;
  scene.add(level_square({0, 0, 0}, 1.0f), scene.add_material(cut));
  pack::Material other = cut;  // a second run of masked batches
  other.base_color_factor = {0.25f, 0.25f, 0.25f, 1};
  scene.add(level_square({0, 1, 0}, 0.25f), scene.add_material(other));
  scene.lights = {point_light({0, 3, 0}, 10, 8)};
  Recipe recipe = recipe_with(Select::per_light, Filter::hard, 0);
  recipe.shade = Shade::lambert;
  const pack::File pack = scene.open();
  const World world(pack);
  Renderer renderer(device(), world);
  const RenderSettings settings = settings_for(look({0, 0.9f, 0}, {0, 0, 0}, 0.5f * pi), 64, 64, recipe);
  const Picture picture = frame(renderer, settings).picture;
  EXPECT_EQ(radiance_at(picture, 60, 32), glm::vec3(0.0f));  // a hole: nothing there
  EXPECT_GT(radiance_at(picture, 8, 32).x, 0.1f);            // lit past the small sheet
  EXPECT_EQ(radiance_at(picture, 28, 32), glm::vec3(0.0f));  // in its shadow
}

TEST_F(RecipesTest, WhatCannotBeRenderedIsRefused) {
  const pack::File pack = small_room(1).open();
  const World world(pack);
  Renderer renderer(device(), world);
  RenderSettings settings = room_settings(recipe_with(Select::light_clusters, Filter::hard, 0.5f));
  EXPECT_THROW(renderer.draw(settings), std::invalid_argument);
  settings.recipe.d_init_m = 0.0f;
  EXPECT_NO_THROW(renderer.draw(settings));
  settings.recipe = recipe_with(Select::light_clusters, Filter::rays, 0.5f);
  EXPECT_THROW(renderer.draw(settings), std::invalid_argument);
  settings.recipe = recipe_with(Select::per_light, Filter::hard, 0);
  settings.recipe.cull = static_cast<Cull>(77);
  try {
    renderer.draw(settings);
    FAIL() << "a renderer takes an answer that it does not know";
  } catch (const std::invalid_argument& error) {
    EXPECT_STREQ(error.what(), "cull: there is no answer of number 77");
  }
  settings.recipe = presets().back().recipe;
  settings.visibility = nullptr;
  EXPECT_THROW(renderer.draw(settings), std::invalid_argument);
  settings.width = 0;
  EXPECT_THROW(renderer.draw(settings), std::invalid_argument);
  settings.width = 1u << 30;
  EXPECT_THROW(renderer.draw(settings), gpu::Error);
}

}  // namespace
}  // namespace chandelier::test
