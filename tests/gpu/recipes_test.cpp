// SPDX-License-Identifier: Apache-2.0
// Whole frames with different recipes: which must give the same picture.
#include "recipes_test.h"

#include <cmath>

#include "shadows/store/cube_array.h"

namespace chandelier::test {
namespace {

TEST_F(RecipesTest, LightClustersOfOneLightEachGiveTheReferencesPicture) {
  const pack::File pack = small_room(20).open();
  const World world(pack);
  Renderer renderer(device(), world);
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
  const World world(pack);
  Renderer renderer(device(), world);
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
  const World world(pack);
  Renderer renderer(device(), world);
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
  const World world(pack);
  Renderer renderer(device(), world);
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
  const World world(pack);
  Renderer renderer(device(), world);
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
    const World world(pack);
    Renderer renderer(device(), world);
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
  const World world(pack);
  Renderer renderer(device(), world);
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
  const World world(pack);
  Renderer renderer(device(), world);
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
  const World world(pack);
  Renderer renderer(device(), world);
  RenderSettings settings = room_settings(presets().back().recipe);
  ASSERT_EQ(settings.recipe.filter, Filter::rays);
  const Frame lit = frame(renderer, settings);
  uint32_t asked = 0;
  settings.visibility = [&](const VisibilityQuery& query) {
    ++asked;
    for (size_t i = 0; i < query.points.size(); ++i) {
      const SurfacePoint& point = query.points[i];
      const bool seen = point.normal_ws != glm::vec3(0.0f);
      const glm::vec3 p = seen ? query.eye_ws + point.position : glm::vec3(0.0f);
      EXPECT_NEAR(p.y, 0.0f, 1e-4f);
      EXPECT_NEAR(point.normal_ws.y, seen ? 1.0f : 0.0f, 1e-3f);
      query.visibility[i] = p.x > 0.0f ? 255 : 0;
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
  const World world(pack);
  Renderer renderer(device(), world);
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
  const World world(pack);
  Renderer renderer(device(), world), another(device(), world);
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

}  // namespace
}  // namespace chandelier::test
