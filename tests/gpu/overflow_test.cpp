// SPDX-License-Identifier: Apache-2.0
// Casters that do not fit the draw buffer: drawn in further passes, which are counted and predicted.
#include "predict/prediction.h"
#include "recipes_test.h"

namespace chandelier::test {
namespace {

class OverflowTest : public RecipesTest {
 protected:
  static FrameStats predicted(const World& world, const RenderSettings& settings) {
    return Predictor(world).predict(settings).stats;
  }
  static void expect_counters(const FrameStats& drawn, const FrameStats& expected) {
    EXPECT_EQ(drawn.shadow_draws, expected.shadow_draws);
    EXPECT_EQ(drawn.shadow_triangles, expected.shadow_triangles);
    EXPECT_EQ(drawn.shadow_rounds, expected.shadow_rounds);
    EXPECT_EQ(drawn.shadow_overflow_passes, expected.shadow_overflow_passes);
  }
};

TEST_F(OverflowTest, ATinyDrawBufferGivesTheSamePictureInMorePasses) {
  const pack::File pack = small_room(8).open();
  const World world(pack);
  Renderer renderer(device(), world);
  for (const Cull cull : {Cull::none, Cull::light_frustum})
    for (const Filter filter : {Filter::hard, Filter::pcss}) {
      RenderSettings settings = room_settings(recipe_with(Select::per_light, filter, 0));
      settings.recipe.cull = cull;
      const Frame whole = frame(renderer, settings);
      EXPECT_EQ(whole.stats.shadow_overflow_passes, 0u);
      uint64_t fewer_passes = 0;
      for (const uint64_t draws : {64u, 24u, 2u}) {
        SCOPED_TRACE(draws);
        settings.most_caster_draws = draws;
        const Frame passes = frame(renderer, settings);
        expect_same(whole, passes);
        EXPECT_EQ(passes.stats.shadow_draws, whole.stats.shadow_draws);
        EXPECT_EQ(passes.stats.shadow_triangles, whole.stats.shadow_triangles);
        EXPECT_GT(passes.stats.shadow_overflow_passes, fewer_passes);
        expect_counters(passes.stats, predicted(world, settings));
        fewer_passes = passes.stats.shadow_overflow_passes;
      }
    }
}

// A group holds as many maps as its memory does, whatever could be drawn into them at worst.
TEST_F(OverflowTest, GroupsAreAsManyAsMemoryAsksFor) {
  const pack::File pack = small_room(40).open();
  const World world(pack);
  Renderer renderer(device(), world);
  RenderSettings settings = room_settings(recipe_with(Select::per_light, Filter::hard, 0));
  settings.most_caster_draws = 512;
  const Frame one = frame(renderer, settings);
  EXPECT_EQ(one.stats.shadow_rounds, 1u);
  expect_counters(one.stats, predicted(world, settings));
  settings.recipe.shadow_budget_bytes = 10 * uint64_t{6} * 4 * 128 * 128;
  const Frame some = frame(renderer, settings);
  EXPECT_EQ(some.stats.shadow_rounds, (one.stats.shadow_maps + 9) / 10);
  EXPECT_NEAR(brightness(some.picture) / brightness(one.picture), 1.0, 1e-5);  // each group's light is summed by itself
}

}  // namespace
}  // namespace chandelier::test
