// SPDX-License-Identifier: Apache-2.0
// Shadow maps that are kept from frame to frame: the picture is that of a renderer that draws all of them, and only
// what changed is drawn again.
#include "recipes_test.h"

namespace chandelier::test {
namespace {

class KeptMapsPictureTest : public RecipesTest {
 protected:
  KeptMapsPictureTest() {
    const uint32_t white = scene_.add_material(plain_material(glm::vec3(0.8f)));
    scene_.add(level_square({0, 0, 0}, 4), white);
    scene_.add(box({-0.5f, 0, -0.5f}, {0.5f, 1, 0.5f}), white);
    scene_.lights = {point_light({-1.5f, 2, 1}, 8, 6), point_light({1.5f, 2, 1}, 8, 6), point_light({0, 2, -2}, 8, 6)};
  }

  RenderSettings settings(const glm::vec3& eye) const {
    RenderSettings settings =
        settings_for(look(eye, {0, 0.5f, 0}, 0.9f), 96, 64, recipe_with(Select::per_light, Filter::hard, 0.0f));
    settings.recipe.face_size_px = 64;
    settings.keep_shadow_maps = true;
    return settings;
  }

  // A renderer that keeps maps, and one that draws all of them.
  struct Both {
    explicit Both(const World& world) : keeps(device(), world), draws(device(), world) {}
    Renderer keeps, draws;
  };

  // Draws with both and returns the statistics of the one that keeps.
  FrameStats drawn(Both& both, const RenderSettings& settings) {
    const Frame kept = frame(both.keeps, settings);
    RenderSettings all = settings;
    all.keep_shadow_maps = false;
    const Frame expected = frame(both.draws, all);
    EXPECT_EQ(kept.picture.radiance, expected.picture.radiance);
    EXPECT_EQ(expected.stats.shadow_maps_kept, 0u);
    EXPECT_LE(kept.stats.shadow_triangles, expected.stats.shadow_triangles);
    EXPECT_EQ(kept.stats.shadow_maps, expected.stats.shadow_maps);
    return kept.stats;
  }

  Scene scene_;
};

constexpr glm::vec3 here{1.5f, 3, 4.5f}, there{-2, 2.5f, 4};

TEST_F(KeptMapsPictureTest, OnlyWhatChangedIsDrawnAgain) {
  const pack::File pack = scene_.open();
  World world(pack);
  Both both(world);
  EXPECT_EQ(drawn(both, settings(here)).shadow_maps_kept, 0u);
  FrameStats stats = drawn(both, settings(here));
  EXPECT_EQ(stats.shadow_maps_kept, 3u);
  EXPECT_EQ(stats.shadow_triangles, 0u);
  stats = drawn(both, settings(there));
  EXPECT_EQ(stats.shadow_maps_kept, 3u) << "the camera moved: cubes stay as they are";

  pack::Light lamp = world.lights()[1];
  lamp.position_ws.y += 0.5f;
  world.set_light(1, lamp);
  stats = drawn(both, settings(there));
  EXPECT_EQ(stats.shadow_maps_kept, 2u);
  EXPECT_GT(stats.shadow_triangles, 0u);

  world.set_transform(1, {glm::vec4(1, 0, 0, 0.5f), glm::vec4(0, 1, 0, 0), glm::vec4(0, 0, 1, 0.5f)});
  EXPECT_EQ(drawn(both, settings(there)).shadow_maps_kept, 0u);
  world.remove_light(0);
  EXPECT_EQ(drawn(both, settings(there)).shadow_maps_kept, 2u);
  RenderSettings smaller = settings(there);
  smaller.recipe.face_size_px = 32;
  EXPECT_EQ(drawn(both, smaller).shadow_maps_kept, 0u);
  smaller.keep_shadow_maps = false;
  EXPECT_EQ(drawn(both, smaller).shadow_maps_kept, 0u);
}

// A map that a frame does not need stays in the store beside those that it draws.
TEST_F(KeptMapsPictureTest, WhatIsOutOfViewStaysForLater) {
  for (pack::Light& light : scene_.lights) light.range_m = 2.2f;
  scene_.add(level_square({40, 0, 0}, 4), 0);
  scene_.lights.push_back(point_light({40, 2, 0}, 8, 6));
  const pack::File pack = scene_.open();
  const World world(pack);
  Both both(world);
  RenderSettings all = settings(here), away = settings(here);
  all.lights_out_of_view = true;
  EXPECT_EQ(drawn(both, all).shadow_maps, 4u);
  EXPECT_EQ(drawn(both, settings(here)).shadow_maps_kept, 3u);
  away.camera = look({41, 3, 3}, {40, 0, 0}, 0.9f);
  const FrameStats stats = drawn(both, away);
  EXPECT_EQ(stats.shadow_maps, 1u);
  EXPECT_EQ(stats.shadow_maps_kept, 1u);
  EXPECT_EQ(drawn(both, settings(here)).shadow_maps_kept, 3u);
}

TEST_F(KeptMapsPictureTest, TheSunsCascadesFollowTheCamera) {
  scene_.lights.push_back(directional_light({0.3f, -1, -0.4f}, 1));
  const pack::File pack = scene_.open();
  const World world(pack);
  Both both(world);
  drawn(both, settings(here));
  EXPECT_EQ(drawn(both, settings(here)).shadow_maps_kept, 4u);
  EXPECT_EQ(drawn(both, settings(there)).shadow_maps_kept, 3u);
}

// Two cubes for three maps: each group takes the places of the one before.
TEST_F(KeptMapsPictureTest, NothingIsKeptWhereMapsTakeSeveralGroups) {
  const pack::File pack = scene_.open();
  const World world(pack);
  Both both(world);
  RenderSettings few = settings(here);
  few.recipe.shadow_budget_bytes = uint64_t{2} * 6 * 4 * 64 * 64;
  for (int i = 0; i < 2; ++i) {
    const FrameStats stats = drawn(both, few);
    EXPECT_EQ(stats.shadow_rounds, 2u);
    EXPECT_EQ(stats.shadow_maps_kept, 0u);
  }
  EXPECT_EQ(drawn(both, settings(here)).shadow_maps_kept, 0u) << "a larger pool";
  EXPECT_EQ(drawn(both, settings(here)).shadow_maps_kept, 3u);
}

// What is culled beyond a light's range differs.
TEST_F(KeptMapsPictureTest, AnotherCullAnswerDrawsAgain) {
  const pack::File pack = scene_.open();
  const World world(pack);
  Both both(world);
  drawn(both, settings(here));
  RenderSettings all = settings(here);
  all.recipe.cull = Cull::none;
  EXPECT_EQ(drawn(both, all).shadow_maps_kept, 0u);
}

// Draws that exceed their buffer take further passes, of which only the first may clear.
TEST_F(KeptMapsPictureTest, FurtherPassesLeaveKeptMapsAlone) {
  const pack::File pack = scene_.open();
  World world(pack);
  Both both(world);
  RenderSettings narrow = settings(here);
  narrow.most_caster_draws = 2;
  drawn(both, narrow);
  pack::Light lamp = world.lights()[2];
  lamp.position_ws.x += 0.5f;
  world.set_light(2, lamp);
  const FrameStats stats = drawn(both, narrow);
  EXPECT_EQ(stats.shadow_maps_kept, 2u);
  EXPECT_GT(stats.shadow_overflow_passes, 0u);
}

}  // namespace
}  // namespace chandelier::test
