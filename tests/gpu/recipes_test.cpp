// SPDX-License-Identifier: Apache-2.0
// Whole frames with different recipes: which must give the same picture, and what a frame must bear.
#include <algorithm>
#include <cmath>
#include <iostream>
#include <random>

#include "gpu_test.h"
#include "shadows/store/cube_array.h"

namespace chandelier::test {
namespace {

constexpr float pi = 3.14159265f;

// A room with a few boxes, a ball and a cut-out sheet, and `lights` lights of all three types in it.
Scene small_room(uint32_t lights) {
  Scene scene;
  const uint32_t grey = scene.add_material(plain_material(glm::vec3(0.5f), 0.0f, 0.5f));
  const uint32_t red = scene.add_material(plain_material({0.7f, 0.2f, 0.1f}, 0.4f, 0.3f));
  pack::Material cut = plain_material(glm::vec3(0.8f));
  cut.base_color_texture = scene.add_texture(2, 2, {0xFFFFFFFFu, 0x00FFFFFFu, 0x00FFFFFFu, 0xFFFFFFFFu});
  cut.alpha_mode = pack::AlphaMode::mask;
  cut.double_sided = 1;
  const uint32_t masked = scene.add_material(cut);
  scene.add(level_square({0, 0, 0}, 4.0f), grey);
  scene.add(quad({0, 2, -3}, {4, 0, 0}, {0, 2, 0}), red);
  for (int i = 0; i < 6; ++i) {
    const float x = -2.5f + static_cast<float>(i), z = i % 2 ? -1.0f : 0.6f;
    scene.add(box({x - 0.2f, 0.0f, z - 0.2f}, {x + 0.2f, 0.5f + 0.2f * static_cast<float>(i), z + 0.2f}),
              i % 2 ? red : grey);
  }
  scene.add(sphere({0.3f, 1.2f, -0.3f}, 0.4f, 24), grey);
  scene.add(quad({-1.2f, 1.4f, -0.4f}, {0.5f, 0, 0.1f}, {0, 0.4f, 0}), masked);
  std::mt19937 random(7);
  const auto uniform = [&](float from, float to) {
    return from + (to - from) * static_cast<float>(random() >> 8) * 0x1p-24f;
  };
  for (uint32_t i = 0; i < lights; ++i) {
    const glm::vec3 at(uniform(-3, 3), uniform(0.7f, 2.8f), uniform(-2.5f, 2.5f));
    const float candela = 20.0f / static_cast<float>(lights), range = uniform(2, 6);
    scene.lights.push_back(i % 3 == 1 ? spot_light(at, {uniform(-1, 1), -1, uniform(-1, 1)}, candela, range, 0.3f, 0.8f)
                                      : point_light(at, candela, range));
    scene.lights.back().color = {uniform(0.3f, 1), uniform(0.3f, 1), uniform(0.3f, 1)};
  }
  scene.lights.push_back(directional_light({0.3f, -1, -0.4f}, 0.5f));
  return scene;
}

RenderSettings room_settings(const Recipe& recipe) {
  RenderSettings settings = settings_for(look({1.5f, 2.2f, 4.5f}, {0, 0.8f, 0}, 0.9f), 128, 96, recipe);
  // For filter rays: everything is lit.
  settings.visibility = [](const VisibilityQuery& query) { std::ranges::fill(query.visibility, uint8_t{255}); };
  return settings;
}

Recipe recipe_with(Select select, Filter filter, float d_init_m) {
  Recipe recipe;
  recipe.select = select;
  recipe.filter = filter;
  recipe.d_init_m = d_init_m;
  recipe.face_size_px = 128;
  return recipe;
}

struct Frame {
  Picture picture;
  FrameStats stats;
};

class RecipesTest : public GpuTest {
 protected:
  Frame frame(Renderer& renderer, const RenderSettings& settings) {
    const FrameStats stats = renderer.draw(settings);
    return {renderer.read_back(), stats};
  }
  static void expect_same(const Frame& a, const Frame& b) {
    EXPECT_TRUE(a.picture.radiance == b.picture.radiance);
    EXPECT_TRUE(a.picture.shown == b.picture.shown);
  }
  static double brightness(const Picture& picture) {
    double sum = 0.0;
    for (size_t i = 0; i < picture.radiance.size(); ++i) sum += i % 4 == 3 ? 0.0 : double{picture.radiance[i]};
    return sum / static_cast<double>(picture.radiance.size() / 4);
  }
};

TEST_F(RecipesTest, LightClustersOfOneLightEachGiveTheReferencesPicture) {
  const pack::File pack = small_room(20).open();
  Renderer renderer(device(), pack);
  for (const Filter filter : {Filter::hard, Filter::pcf, Filter::pcss}) {
    const Frame reference = frame(renderer, room_settings(recipe_with(Select::per_light, filter, 0)));
    RenderSettings settings = room_settings(recipe_with(Select::light_clusters, filter, 0));
    settings.recipe.reference_share = 1.5f;
    const Frame clustered = frame(renderer, settings);
    EXPECT_EQ(clustered.stats.light_clusters, reference.stats.lights_in_view);
    EXPECT_GT(brightness(reference.picture), 0.001);
    expect_same(reference, clustered);
  }
}

// LightCluster §5.4: clusters that are nearly as many as lights are not worth a soft filter.
TEST_F(RecipesTest, TheReferenceIsDrawnWhereClustersAreNearlyAsManyAsLights) {
  const pack::File pack = small_room(20).open();
  Renderer renderer(device(), pack);
  const Frame reference = frame(renderer, room_settings(recipe_with(Select::per_light, Filter::hard, 0)));
  RenderSettings settings = room_settings(recipe_with(Select::light_clusters, Filter::pcf, 0.1f));
  settings.recipe.deliver = Deliver::textures;
  const Frame instead = frame(renderer, settings);
  EXPECT_EQ(instead.stats.reference_path, 1u);
  EXPECT_EQ(instead.stats.visibility_bytes, 0u);
  expect_same(reference, instead);
  settings.recipe.reference_share = 1.5f;
  const Frame clusters = frame(renderer, settings);
  EXPECT_EQ(clusters.stats.reference_path, 0u);
  EXPECT_NE(clusters.picture.radiance, reference.picture.radiance);
}

TEST_F(RecipesTest, LightClustersShareMaps) {
  const pack::File pack = small_room(20).open();
  Renderer renderer(device(), pack);
  const Frame reference = frame(renderer, room_settings(recipe_with(Select::per_light, Filter::pcf, 0)));
  const Frame clustered = frame(renderer, room_settings(recipe_with(Select::light_clusters, Filter::pcf, 1.5f)));
  EXPECT_EQ(clustered.stats.lights_in_view, reference.stats.lights_in_view);
  EXPECT_LT(clustered.stats.shadow_maps, reference.stats.shadow_maps / 2);
  EXPECT_LT(clustered.stats.shadow_triangles, reference.stats.shadow_triangles);
  EXPECT_NEAR(brightness(clustered.picture) / brightness(reference.picture), 1.0, 0.2);  // no light is lost or doubled
}

// Each light keeps its direction and colour and takes its shadows from the brightest of its cluster.
TEST_F(RecipesTest, DirectionalLightsShareCascades) {
  Scene scene = small_room(0);
  scene.lights.push_back(directional_light({0.31f, -1, -0.4f}, 2.0f));
  scene.lights.push_back(directional_light({-1, -1, 0.2f}, 0.5f));
  scene.lights[0].color = {1, 0.2f, 0.2f};
  const pack::File pack = scene.open();
  Renderer renderer(device(), pack);
  const Frame reference = frame(renderer, room_settings(recipe_with(Select::per_light, Filter::pcf, 0)));
  const Frame clustered = frame(renderer, room_settings(recipe_with(Select::light_clusters, Filter::pcf, 0.5f)));
  EXPECT_EQ(reference.stats.centers, (std::vector<uint32_t>{0, 1, 2}));
  EXPECT_EQ(clustered.stats.centers, (std::vector<uint32_t>{1, 1, 2}));
  EXPECT_EQ(clustered.stats.shadow_maps, 2u);
  double difference = 0.0;
  for (size_t i = 0; i < reference.picture.radiance.size(); ++i)
    difference += std::abs(reference.picture.radiance[i] - clustered.picture.radiance[i]);
  difference /= static_cast<double>(reference.picture.radiance.size() / 4);
  EXPECT_GT(difference, 0.0);
  EXPECT_LT(difference, 0.01 * brightness(reference.picture));
}

TEST_F(RecipesTest, MapsThatTakeTurnsInTheStoreGiveTheSamePicture) {
  const pack::File pack = small_room(9).open();
  Renderer renderer(device(), pack);
  for (const Select select : {Select::per_light, Select::light_clusters}) {
    for (const uint64_t cubes : {1u, 4u}) {
      RenderSettings settings = room_settings(recipe_with(select, Filter::pcf, 0.8f));
      const Frame at_once = frame(renderer, settings);
      settings.recipe.shadow_budget_bytes = cubes * cube_bytes(settings.recipe.face_size_px);
      const Frame in_turns = frame(renderer, settings);
      EXPECT_EQ(at_once.stats.shadow_rounds, 1u);
      EXPECT_EQ(in_turns.stats.shadow_rounds, (in_turns.stats.shadow_maps + cubes - 1) / cubes);
      EXPECT_EQ(in_turns.stats.shadow_pool_bytes, settings.recipe.shadow_budget_bytes);
      EXPECT_EQ(in_turns.stats.shadow_bytes, at_once.stats.shadow_bytes);
      EXPECT_EQ(in_turns.stats.shadow_triangles, at_once.stats.shadow_triangles);
      // The sums may be taken in another grouping, but hold the same terms.
      ASSERT_EQ(at_once.picture.radiance.size(), in_turns.picture.radiance.size());
      for (size_t i = 0; i < at_once.picture.radiance.size(); ++i)
        ASSERT_NEAR(at_once.picture.radiance[i], in_turns.picture.radiance[i],
                    1e-6f + 1e-5f * at_once.picture.radiance[i]);
    }
  }
}

// More lights than a word of a tile has bits, and than a work group has threads; a picture that ends within a tile.
TEST_F(RecipesTest, TilesGiveThePictureOfAllLights) {
  for (const uint32_t lights : {5u, 70u, 600u}) {
    const pack::File pack = small_room(lights).open();
    Renderer renderer(device(), pack);
    for (const Deliver deliver : {Deliver::inlined, Deliver::textures}) {
      RenderSettings settings = room_settings(recipe_with(Select::light_clusters, Filter::pcf, 0.4f));
      settings.width = 117;
      settings.height = 83;
      settings.recipe.face_size_px = 32;
      settings.recipe.deliver = deliver;
      settings.recipe.lookup = Lookup::all;
      const Frame all = frame(renderer, settings);
      settings.recipe.lookup = Lookup::tiles;
      expect_same(all, frame(renderer, settings));
      EXPECT_GT(brightness(all.picture), 0.0);
    }
  }
}

// A byte holds hard visibility exactly, and filtered visibility to half a 255th of each light's share.
TEST_F(RecipesTest, VisibilityTexturesGiveThePictureOfInlineVisibility) {
  const pack::File pack = small_room(20).open();
  Renderer renderer(device(), pack);
  for (const Filter filter : {Filter::hard, Filter::pcf, Filter::pcss}) {
    RenderSettings settings = room_settings(recipe_with(Select::per_light, filter, 0));
    const Frame inlined = frame(renderer, settings);
    settings.recipe.deliver = Deliver::textures;
    const Frame textures = frame(renderer, settings);
    if (filter == Filter::hard) expect_same(inlined, textures);
    for (size_t i = 0; i < inlined.picture.radiance.size(); ++i)
      ASSERT_NEAR(inlined.picture.radiance[i], textures.picture.radiance[i], 0.003f);
    EXPECT_EQ(inlined.stats.visibility_bytes, 0u);
    EXPECT_GT(textures.stats.visibility_bytes, 0u);
    EXPECT_LE(textures.stats.visibility_bytes, textures.stats.shadow_maps * settings.width * settings.height);
  }
}

// A light beside and behind the camera passes the planes of the frustum and yet reaches no pixel: no byte is needed.
TEST_F(RecipesTest, VisibilityTexturesMayAllBeEmpty) {
  Scene scene = small_room(0);
  scene.lights = {point_light({0.5f, 1, 1}, 50, 1.08f)};
  const pack::File pack = scene.open();
  Renderer renderer(device(), pack);
  RenderSettings settings = room_settings(recipe_with(Select::per_light, Filter::pcf, 0));
  settings.camera = look({0, 1, 0}, {0, 1, -1}, 0.5f * pi);
  settings.width = settings.height = 64;
  settings.recipe.deliver = Deliver::textures;
  const Frame empty = frame(renderer, settings);
  EXPECT_EQ(empty.stats.shadow_maps, 1u);
  EXPECT_EQ(empty.stats.visibility_bytes, 0u);
  EXPECT_EQ(brightness(empty.picture), 0.0);
}

// What is asked are the points that the camera sees, and the answer is what shading uses.
TEST_F(RecipesTest, RaysAreAskedAboutEveryVisiblePoint) {
  Scene scene;
  scene.add(level_square({0, 0, 0}, 50.0f), scene.add_material(plain_material(glm::vec3(0.5f))));
  scene.lights = {point_light({0, 2, 0}, 10, 5), directional_light({0, -1, 0}, 1)};
  const pack::File pack = scene.open();
  Renderer renderer(device(), pack);
  RenderSettings settings = room_settings(presets().back().recipe);
  ASSERT_EQ(settings.recipe.filter, Filter::rays);
  const Frame lit = frame(renderer, settings);
  uint32_t asked = 0;
  settings.visibility = [&](const VisibilityQuery& query) {
    ++asked;
    for (size_t i = 0; i < query.points.size(); ++i) {
      const SurfacePoint& point = query.points[i];
      const bool seen = point.normal_ws != glm::vec3(0.0f);
      EXPECT_NEAR(point.position_ws.y, 0.0f, 1e-4f);
      EXPECT_NEAR(point.normal_ws.y, seen ? 1.0f : 0.0f, 1e-3f);
      query.visibility[i] = point.position_ws.x > 0.0f ? 255 : 0;
    }
  };
  const Frame half = frame(renderer, settings);
  EXPECT_EQ(asked, 2u);
  EXPECT_EQ(half.stats.shadow_maps, 0u);
  for (uint32_t y = 0; y < settings.height; y += 5) {
    for (uint32_t x = 0; x < settings.width; x += 5) {
      if (pixel_direction(settings, x, y).y > -0.05f) continue;
      const float at = floor_point(settings, x, y).x;
      if (std::abs(at) < 0.01f) continue;
      EXPECT_EQ(radiance_at(half.picture, x, y), at > 0.0f ? radiance_at(lit.picture, x, y) : glm::vec3(0.0f));
    }
  }
}

TEST_F(RecipesTest, CullingChangesWorkButNotThePicture) {
  const pack::File pack = small_room(12).open();
  Renderer renderer(device(), pack);
  RenderSettings settings = room_settings(recipe_with(Select::per_light, Filter::hard, 0));
  const Frame culled = frame(renderer, settings);
  settings.recipe.cull = Cull::none;
  const Frame everything = frame(renderer, settings);
  expect_same(culled, everything);
  EXPECT_GT(everything.stats.shadow_triangles, 2 * culled.stats.shadow_triangles);
  EXPECT_GT(culled.stats.shadow_triangles, 0u);
}

TEST_F(RecipesTest, TheSameFrameTwiceIsTheSameBits) {
  const pack::File pack = small_room(20).open();
  Renderer renderer(device(), pack), another(device(), pack);
  for (const Preset& preset : presets()) {
    SCOPED_TRACE(preset.name);
    RenderSettings settings = room_settings(preset.recipe);
    settings.recipe.face_size_px = 128;
    settings.exposure_ev.reset();
    const Frame first = frame(renderer, settings);
    expect_same(first, frame(renderer, settings));
    expect_same(first, frame(another, settings));
    EXPECT_EQ(first.stats.shadow_triangles, frame(renderer, settings).stats.shadow_triangles);
  }
}

TEST_F(RecipesTest, SizesMayChangeFromFrameToFrame) {
  const pack::File pack = small_room(6).open();
  Renderer renderer(device(), pack);
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
  Renderer renderer(device(), pack);
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
  Renderer renderer(device(), pack);
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
  Renderer renderer(device(), pack);
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
  Renderer renderer(device(), pack);
  for (const Preset& preset : presets()) {
    RenderSettings settings = room_settings(preset.recipe);
    settings.exposure_ev.reset();
    const Frame dark = frame(renderer, settings);
    EXPECT_EQ(brightness(dark.picture), 0.0);
    EXPECT_EQ(dark.stats.shadow_maps, 0u);
    settings.ambient = 0.25f;
    const auto center = radiance_at(frame(renderer, settings).picture, 64, 90);
    EXPECT_NEAR(center.x, 0.125f, 0.001f);  // the floor's 0.5
  }
}

TEST_F(RecipesTest, NoTriangles) {
  Scene scene;
  scene.lights = {point_light({0, 1, 0}, 10, 5), directional_light({0, -1, 0}, 1),
                  spot_light({0, 1, 0}, {0, -1, 0}, 10, 5, 0.1f, 0.2f)};
  const pack::File pack = scene.open();
  Renderer renderer(device(), pack);
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
  Renderer renderer(device(), pack);
  const RenderSettings settings = settings_for(look({0, 0.9f, 0}, {0, 0, 0}, 0.5f * pi), 64, 64, recipe);
  const Picture picture = frame(renderer, settings).picture;
  EXPECT_EQ(radiance_at(picture, 60, 32), glm::vec3(0.0f));  // a hole: nothing there
  EXPECT_GT(radiance_at(picture, 8, 32).x, 0.1f);            // lit past the small sheet
  EXPECT_EQ(radiance_at(picture, 28, 32), glm::vec3(0.0f));  // in its shadow
}

TEST_F(RecipesTest, WhatCannotBeRenderedIsRefused) {
  const pack::File pack = small_room(1).open();
  Renderer renderer(device(), pack);
  RenderSettings settings = room_settings(recipe_with(Select::light_clusters, Filter::hard, 0.5f));
  EXPECT_THROW(renderer.draw(settings), std::invalid_argument);
  settings.recipe.d_init_m = 0.0f;
  EXPECT_NO_THROW(renderer.draw(settings));
  settings.recipe = recipe_with(Select::light_clusters, Filter::rays, 0.5f);
  EXPECT_THROW(renderer.draw(settings), std::invalid_argument);
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
