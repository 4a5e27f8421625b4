// SPDX-License-Identifier: Apache-2.0
// Meshes and materials that cast no shadow: seen as ever, and no light knows of them.
#include <gtest/gtest.h>

#include <algorithm>

#include "gpu_test.h"
#include "predict/prediction.h"
#include "truth/ray_traced.h"

namespace chandelier::test {
namespace {

constexpr uint32_t width = 96, height = 72;

enum class Without { nothing, instance, material };

// A floor under a ball, a box and a cut-out sheet, and lamps of all types above. `without` says what of the three
// casts no shadow, and by which of its marks.
pack::File things_over_a_floor(Without without) {
  Scene scene;
  pack::Material floor = plain_material(glm::vec3(0.6f)), thing = plain_material({0.7f, 0.4f, 0.2f}), cut = thing;
  thing.shadowless = cut.shadowless = without == Without::material;
  cut.base_color_texture = scene.add_texture(2, 2, {0xFFFFFFFFu, 0x00FFFFFFu, 0x00FFFFFFu, 0xFFFFFFFFu});
  cut.alpha_mode = pack::AlphaMode::mask;
  cut.double_sided = 1;
  const uint32_t floor_number = scene.add_material(floor), opaque = scene.add_material(thing),
                 masked = scene.add_material(cut);
  scene.add(level_square({0, 0, 0}, 5), floor_number);
  const std::pair<Mesh, uint32_t> things[]{{sphere({-1.2f, 0.9f, 0}, 0.4f, 24), opaque},
                                           {box({-0.3f, 0.4f, -0.3f}, {0.3f, 1.0f, 0.3f}), opaque},
                                           {quad({1.2f, 0.8f, 0}, {0.5f, 0, 0}, {0, 0.1f, -0.5f}), masked}};
  for (const auto& [mesh, material] : things) {
    scene.add(mesh, material);
    if (without == Without::instance) scene.take_shadow();
  }
  for (int i = 0; i < 6; ++i) {
    const float x = 0.7f * (static_cast<float>(i) - 2.5f);
    scene.lights.push_back(i % 3 == 2 ? spot_light({x, 2.5f, 0.4f}, {0, -1, -0.1f}, 9, 6, 0.5f, 1.0f)
                                      : point_light({x, 2.2f, 0.3f * x}, 5, 5));
  }
  scene.lights.push_back(directional_light({0.2f, -1, 0.1f}, 0.4f));
  return scene.open();
}

Recipe recipe_with(Select select, Cull cull, Filter filter, Deliver deliver, Lookup lookup) {
  Recipe recipe;
  recipe.select = select;
  recipe.cull = cull;
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

class CastersTest : public GpuTest {
 protected:
  static RenderSettings settings_of(const Recipe& recipe) {
    return settings_for(look({1.5f, 3.0f, 4}, {0, 0.4f, 0}, 0.9f), width, height, recipe);
  }
  Frame frame(const World& world, const Recipe& recipe, const VisibilitySource& rays = {}) {
    Renderer renderer(device(), world);
    RenderSettings settings = settings_of(recipe);
    settings.visibility = rays;
    const FrameStats stats = renderer.draw(settings);
    return {renderer.read_back(), stats};
  }
  // Where no light knows of anything.
  Picture lit_everywhere() {
    const Recipe recipe = recipe_with(Select::per_light, Cull::none, Filter::rays, Deliver::textures, Lookup::tiles);
    const pack::File pack = things_over_a_floor(Without::nothing);
    const World world(pack);
    return frame(world, recipe, [](const VisibilityQuery& query) { std::ranges::fill(query.visibility, uint8_t{255}); })
        .picture;
  }
  static uint64_t different_pixels(const Picture& a, const Picture& b) {
    uint64_t count = 0;
    for (size_t i = 0; i < a.radiance.size(); i += 4) {
      bool differs = false;
      for (size_t c = i; c < i + 3; ++c)
        differs = differs || std::abs(a.radiance[c] - b.radiance[c]) > 1e-5f * std::max(1.0f, b.radiance[c]);
      count += differs;
    }
    return count;
  }
};

TEST_F(CastersTest, WhatThrowsNoShadowIsSeenAndDarkensNothingInAnyRecipe) {
  const pack::File whole_pack = things_over_a_floor(Without::nothing);
  const World whole(whole_pack);
  const Picture lit = lit_everywhere();
  for (const Select select : {Select::per_light, Select::light_clusters})
    for (const Cull cull : {Cull::none, Cull::light_frustum})
      for (const Filter filter : {Filter::hard, Filter::pcf, Filter::pcss})
        for (const Deliver deliver : {Deliver::inlined, Deliver::textures}) {
          SCOPED_TRACE(testing::Message() << "select " << static_cast<uint32_t>(select) << ", cull "
                                          << static_cast<uint32_t>(cull) << ", filter " << static_cast<uint32_t>(filter)
                                          << ", deliver " << static_cast<uint32_t>(deliver));
          const Recipe recipe = recipe_with(select, cull, filter, deliver, Lookup::tiles);
          EXPECT_GT(different_pixels(frame(whole, recipe).picture, lit), 400u);
          for (const Without mark : {Without::instance, Without::material}) {
            const pack::File pack = things_over_a_floor(mark);
            const World world(pack);
            const Frame found = frame(world, recipe);
            EXPECT_EQ(different_pixels(found.picture, lit), 0u);
            EXPECT_GT(found.stats.shadow_maps, 0u);
          }
        }
}

// Whatever casts shadows is in shadow maps, and nothing else: counted by the device, and predicted without one.
TEST_F(CastersTest, OnlyCastersAreDrawnAndPredicted) {
  for (const Cull cull : {Cull::none, Cull::light_frustum}) {
    const Recipe recipe = recipe_with(Select::per_light, cull, Filter::hard, Deliver::inlined, Lookup::tiles);
    for (const Without mark : {Without::nothing, Without::instance, Without::material}) {
      const pack::File pack = things_over_a_floor(mark);
      const World world(pack);
      const Frame found = frame(world, recipe);
      Predictor predictor(world);
      const FrameStats predicted = predictor.predict(settings_of(recipe)).stats;
      EXPECT_EQ(found.stats.shadow_triangles, predicted.shadow_triangles);
      EXPECT_EQ(found.stats.shadow_draws, predicted.shadow_draws);
      if (cull != Cull::none) continue;
      const uint64_t all = pack.view().indices.size() / 3, floor = 2;
      EXPECT_EQ(found.stats.shadow_triangles, found.stats.shadow_views * (mark == Without::nothing ? all : floor));
    }
  }
}

TEST_F(CastersTest, RaysKnowOfCastersAlone) {
  const Recipe recipe = recipe_with(Select::per_light, Cull::none, Filter::rays, Deliver::textures, Lookup::tiles);
  const Picture lit = lit_everywhere();
  for (const Without mark : {Without::nothing, Without::instance, Without::material}) {
    const pack::File pack = things_over_a_floor(mark);
    const World world(pack);
    const Picture found = frame(world, recipe, truth::ray_traced_visibility(world)).picture;
    if (mark == Without::nothing)
      EXPECT_GT(different_pixels(found, lit), 400u);
    else
      EXPECT_EQ(different_pixels(found, lit), 0u);
  }
}

}  // namespace
}  // namespace chandelier::test
