// SPDX-License-Identifier: Apache-2.0
// A world that changes between frames is drawn as if it had been baked so.
#include <chrono>
#include <thread>

#include "recipes_test.h"
#include "truth/ray_traced.h"

namespace chandelier::test {
namespace {

constexpr glm::vec3 box_at{0.5f, 0, -1}, box_to{-1.25f, 0.5f, 0.75f};
constexpr glm::vec3 lamp_at{0, 2.5f, 0}, lamp_to{1.5f, 2, 1};

// Corners and places are exact in floats, so that the boxes of what has moved are those of a bake.
Scene scene_with(const glm::vec3& box, const glm::vec3& lamp) {
  Scene scene;
  const uint32_t white = scene.add_material(plain_material(glm::vec3(0.8f)));
  scene.add(level_square({0, 0, 0}, 4), white);
  glm::mat4 place(1.0f);
  place[3] = glm::vec4(box, 1);
  scene.add(test::box({-0.5f, 0, -0.5f}, {0.5f, 1, 0.5f}), white, place);
  scene.lights = {point_light(lamp, 20, 8), point_light({-2, 1.5f, 2}, 5, 6), directional_light({0.3f, -1, -0.4f}, 1)};
  return scene;
}

void move_box(World& world, const glm::vec3& to) {
  world.set_transform(1, {glm::vec4(1, 0, 0, to.x), glm::vec4(0, 1, 0, to.y), glm::vec4(0, 0, 1, to.z)});
}

void move_lamp(World& world, const glm::vec3& to) {
  pack::Light lamp = world.lights()[0];
  lamp.position_ws = to;
  world.set_light(0, lamp);
}

class WorldPictureTest : public RecipesTest {
 protected:
  RenderSettings settings_with(const Recipe& recipe) const {
    return settings_for(look({1.5f, 3, 4.5f}, {0, 0.5f, 0}, 0.9f), 128, 96, recipe);
  }
  Frame baked(const Scene& scene, const RenderSettings& settings) {
    const pack::File pack = scene.open();
    const World world(pack);
    Renderer renderer(device(), world);
    return frame(renderer, settings);
  }
  // All answers that read the world in their own way.
  std::vector<RenderSettings> all_settings() const {
    std::vector<RenderSettings> all;
    for (const Recipe& recipe :
         {recipe_with(Select::per_light, Filter::hard, 0.0f), recipe_with(Select::light_clusters, Filter::pcss, 3.0f),
          recipe_with(Select::error_driven, Filter::hard, 0.5f)})
      all.push_back(settings_with(recipe));
    all.back().recipe.max_maps = 2;
    return all;
  }
};

TEST_F(WorldPictureTest, AMovedLightIsDrawnAsABakedOne) {
  const pack::File pack = scene_with(box_at, lamp_at).open();
  for (const RenderSettings& settings : all_settings()) {
    World world(pack);
    Renderer renderer(device(), world);
    const Frame before = frame(renderer, settings);
    move_lamp(world, lamp_to);
    const Frame after = frame(renderer, settings);
    EXPECT_FALSE(after.picture.radiance == before.picture.radiance);
    expect_same(after, baked(scene_with(box_at, lamp_to), settings));
    move_lamp(world, lamp_at);
    expect_same(frame(renderer, settings), before);
  }
}

TEST_F(WorldPictureTest, AMovedInstanceIsDrawnAsABakedOne) {
  const pack::File pack = scene_with(box_at, lamp_at).open();
  for (const RenderSettings& settings : all_settings()) {
    World world(pack);
    Renderer renderer(device(), world);
    const Frame before = frame(renderer, settings);
    move_box(world, box_to);
    const Frame after = frame(renderer, settings);
    EXPECT_FALSE(after.picture.radiance == before.picture.radiance);
    const Frame expected = baked(scene_with(box_to, lamp_at), settings);
    expect_same(after, expected);
    EXPECT_EQ(after.stats.shadow_triangles, expected.stats.shadow_triangles);
    Renderer later(device(), world);
    expect_same(frame(later, settings), expected);
  }
}

TEST_F(WorldPictureTest, LightsComeAndGo) {
  Scene scene = scene_with(box_at, lamp_at);
  const Scene fewer = [&] {
    Scene without = scene;
    without.lights.erase(without.lights.begin() + 1);
    return without;
  }();
  const pack::File pack = scene.open();
  for (const RenderSettings& settings : all_settings()) {
    World world(pack, {.lights = 1});
    Renderer renderer(device(), world);
    const Frame before = frame(renderer, settings);
    world.remove_light(1);
    const Frame without = frame(renderer, settings);
    expect_same(without, baked(fewer, settings));
    EXPECT_EQ(without.stats.lights, 2u);
    EXPECT_EQ(without.stats.centers[1], pack::none);
    world.set_light(1, pack.view().lights[1]);
    expect_same(frame(renderer, settings), before);
    const LightId added = world.add_light(point_light({2, 2, -2}, 9, 5));
    const Frame more = frame(renderer, settings);
    EXPECT_EQ(more.stats.lights, 4u);
    EXPECT_NE(more.stats.centers[added], pack::none);
    EXPECT_GT(brightness(more.picture), brightness(before.picture));
  }
}

// A host draws again as long as there is one: it must come to rest when nobody asks for a selection by error any more.
TEST_F(WorldPictureTest, ANewSelectionIsNewsOnlyWhereTheLastWasProvisional) {
  const pack::File pack = scene_with(box_at, lamp_at).open();
  const World world(pack);
  Renderer renderer(device(), world);
  RenderSettings by_error = all_settings().back();
  by_error.search_beside_frames = true;
  EXPECT_FALSE(renderer.has_new_selection());
  EXPECT_TRUE(renderer.draw(by_error).selection_is_provisional);
  while (!renderer.has_new_selection()) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  EXPECT_FALSE(renderer.draw(all_settings().front()).selection_is_provisional);  // with a map for each light
  EXPECT_FALSE(renderer.has_new_selection());
  EXPECT_FALSE(renderer.draw(by_error).selection_is_provisional);
  EXPECT_FALSE(renderer.has_new_selection());
}

// Rays on the CPU stand where the world does.
TEST_F(WorldPictureTest, TruthFollows) {
  RenderSettings settings = settings_with(presets().back().recipe);
  const auto traced = [&](const World& world) {
    settings.visibility = truth::ray_traced_visibility(world);
    Renderer renderer(device(), world);
    return frame(renderer, settings);
  };
  const pack::File pack = scene_with(box_at, lamp_at).open(), moved = scene_with(box_to, lamp_to).open();
  World world(pack);
  settings.visibility = truth::ray_traced_visibility(world);
  Renderer renderer(device(), world);
  const Frame before = frame(renderer, settings);
  move_box(world, box_to);
  move_lamp(world, lamp_to);
  const Frame after = frame(renderer, settings);
  EXPECT_FALSE(after.picture.radiance == before.picture.radiance);
  expect_same(after, traced(World(moved)));
}

}  // namespace
}  // namespace chandelier::test
