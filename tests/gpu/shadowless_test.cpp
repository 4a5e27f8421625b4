// SPDX-License-Identifier: Apache-2.0
// Lights without shadow against the same lights in a frame in which nothing casts a shadow.
#include <gtest/gtest.h>

#include <algorithm>

#include "frame/renderer.h"
#include "gpu_test.h"
#include "scene_builder.h"

namespace chandelier::test {
namespace {

constexpr uint32_t width = 96, height = 72;

enum Lamps : uint32_t { first = 1, second = 2, all = 3 };

// A floor under a box, and lamps above: those of the first kind cast shadows, those of the second only if so told.
pack::File boxed_floor(Lamps kinds, uint32_t second_shadowless) {
  constexpr uint32_t lamps = 6;
  Scene scene;
  const uint32_t material = scene.add_material(plain_material(glm::vec3(0.6f)));
  scene.add(level_square({0, 0, 0}, 5), material);
  scene.add(box({-0.7f, 0.5f, -0.7f}, {0.7f, 1.0f, 0.7f}), material);
  for (uint32_t i = 0; i < lamps; ++i) {
    const float x = static_cast<float>(i) - 0.5f * static_cast<float>(lamps - 1);
    pack::Light lamp = i % 3 == 2 ? spot_light({0.6f * x, 2.5f, 0.3f}, {0, -1, 0}, 9, 6, 0.5f, 1.0f)
                                  : point_light({0.6f * x, 2.2f, 0.2f * x}, 5, 5);
    if (i % 2 == 0 && kinds & first) scene.lights.push_back(lamp);
    lamp.shadowless = second_shadowless;
    if (i % 2 == 1 && kinds & second) scene.lights.push_back(lamp);
  }
  if (kinds & second) {
    scene.lights.push_back(directional_light({0.2f, -1, 0.1f}, 0.4f));
    scene.lights.back().shadowless = second_shadowless;
  }
  return scene.open();
}

Recipe recipe_with(Select select, Filter filter, Deliver deliver, Lookup lookup) {
  Recipe recipe;
  recipe.select = select;
  recipe.filter = filter;
  recipe.deliver = deliver;
  recipe.lookup = lookup;
  recipe.face_size_px = 128;
  recipe.reference_share = 2.0f;
  recipe.d_init_m = filter == Filter::hard ? 0.0f : 1.0f;
  return recipe;
}

struct Frame {
  Picture picture;
  FrameStats stats;
};

class ShadowlessTest : public GpuTest {
 protected:
  Frame frame(const pack::File& pack, const Recipe& recipe) {
    const World world(pack);
    Renderer renderer(device(), world);
    RenderSettings settings = settings_for(look({2.5f, 3.5f, 4}, {0, 0.3f, 0}, 0.9f), width, height, recipe);
    settings.visibility = [](const VisibilityQuery& query) { std::ranges::fill(query.visibility, uint8_t{255}); };
    const FrameStats stats = renderer.draw(settings);
    return {renderer.read_back(), stats};
  }
  // The second kind's light where nothing is in its way, of lamps that could cast shadows.
  Picture lit_everywhere() {
    return frame(boxed_floor(second, 0), recipe_with(Select::per_light, Filter::rays, Deliver::textures, Lookup::tiles))
        .picture;
  }
};

TEST_F(ShadowlessTest, LightShinesThroughEverything) {
  const pack::File pack = boxed_floor(second, 1);
  const Picture found =
      frame(pack, recipe_with(Select::per_light, Filter::hard, Deliver::inlined, Lookup::tiles)).picture;
  const Picture expected = lit_everywhere();
  EXPECT_EQ(found.radiance, expected.radiance);
  const Frame without = frame(pack, recipe_with(Select::light_clusters, Filter::pcss, Deliver::textures, Lookup::all));
  EXPECT_EQ(without.picture.radiance, expected.radiance);
  EXPECT_EQ(without.stats.lights_in_view, 4u);
  EXPECT_EQ(without.stats.shadowless_in_view, 4u);
  EXPECT_EQ(without.stats.shadow_maps, 0u);
  EXPECT_EQ(without.stats.shadow_rounds, 0u);
  EXPECT_EQ(without.stats.shadow_bytes, 0u);
  const Recipe rays = recipe_with(Select::per_light, Filter::rays, Deliver::textures, Lookup::tiles);
  EXPECT_EQ(frame(pack, rays).picture.radiance, expected.radiance);
}

// Whatever the answers, a picture is the sum of what lights with and lights without shadow make of it.
TEST_F(ShadowlessTest, LightAddsToThatOfOthers) {
  const pack::File both = boxed_floor(all, 1), shadowed = boxed_floor(first, 1);
  const Picture through = lit_everywhere();
  for (const Select select : {Select::per_light, Select::light_clusters})
    for (const Filter filter : {Filter::hard, Filter::pcf, Filter::pcss, Filter::rays})
      for (const Deliver deliver : {Deliver::inlined, Deliver::textures})
        for (const Lookup lookup : {Lookup::all, Lookup::tiles}) {
          Recipe recipe = recipe_with(select, filter, deliver, lookup);
          if (refusal(recipe)) continue;
          if (lookup == Lookup::all) recipe.shadow_budget_bytes = 1;  // a round for each map
          const Frame mixed = frame(both, recipe), alone = frame(shadowed, recipe);
          EXPECT_EQ(mixed.stats.shadow_maps, alone.stats.shadow_maps);
          EXPECT_EQ(mixed.stats.shadow_rounds, alone.stats.shadow_rounds);
          float worst = 0.0f, brightest = 0.0f;
          for (size_t i = 0; i < mixed.picture.radiance.size(); ++i) {
            if (i % 4 == 3) continue;
            const float sum = alone.picture.radiance[i] + through.radiance[i];
            worst = std::max(worst, std::abs(mixed.picture.radiance[i] - sum));
            brightest = std::max(brightest, sum);
          }
          EXPECT_GT(brightest, 0.1f);
          EXPECT_LT(worst, 1e-5f * brightest)
              << "select " << static_cast<uint32_t>(select) << ", filter " << static_cast<uint32_t>(filter)
              << ", deliver " << static_cast<uint32_t>(deliver) << ", lookup " << static_cast<uint32_t>(lookup);
        }
}

}  // namespace
}  // namespace chandelier::test
