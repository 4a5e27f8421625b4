// SPDX-License-Identifier: Apache-2.0
// What becomes of a pack's lights in a frame's list: directional clusters, lights with a map of their own, area lights.
#include "lights/light_list.h"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

#include "world_of.h"

namespace chandelier {
namespace {

using test::world_of;

pack::Light light_at(const glm::vec3& position_ws, float range_m) {
  pack::Light light;
  light.position_ws = position_ws;
  light.range_m = range_m;
  light.direction_ws = {0, -1, 0};
  light.intensity = 2.0f;
  light.color = glm::vec3(1.0f);
  light.type = pack::LightType::point;
  light.inner_cone_cos = 1.0f;
  light.outer_cone_cos = -1.0f;
  return light;
}

pack::Light sun(const glm::vec3& direction, float lux) {
  pack::Light light = light_at({}, 0);
  light.type = pack::LightType::directional;
  light.direction_ws = glm::normalize(direction);
  light.intensity = lux;
  return light;
}

Recipe clustering(float d_init_m) {
  Recipe recipe;
  recipe.select = Select::light_clusters;
  recipe.filter = Filter::pcf;
  recipe.d_init_m = d_init_m;
  recipe.distance_scaling = DistanceScaling::none;
  return recipe;
}

// A camera at the origin that looks along -z sees all of these.
TEST(LightListTest, CentersAreNumbersOfThePack) {
  const pack::Light lights[]{light_at({0, 0, -4}, 1), light_at({0, 0, 90}, 1), light_at({0, 0, -4.2f}, 2),
                             light_at({3, 0, -9}, 2)};
  const LightList list = select_lights(world_of(lights), clustering(0.5f), {}, 1.0f);
  EXPECT_EQ(list.light_id, (std::vector<uint32_t>{0, 2, 3}));
  EXPECT_EQ(list.center, (std::vector<uint32_t>{2, 2, 3}));
  EXPECT_EQ(list.maps[0].center_ws, lights[2].position_ws);
  EXPECT_EQ(select_lights(world_of(lights), {}, {}, 1.0f).center, (std::vector<uint32_t>{0, 2, 3}));
}

// Chords of 1/30 and 1/15: with z_far 30 m as far apart as d_init of 1 m and 2 m.
TEST(LightListTest, DirectionalLightsShareAMapWhereTheirDirectionsAreNear) {
  const auto tilted = [](float rad) { return glm::vec3(std::sin(rad), -std::cos(rad), 0); };
  const pack::Light lights[]{sun(tilted(0.0f), 1), sun(tilted(1.0f / 30.0f), 5), sun(tilted(2.0f / 30.0f), 2),
                             sun(tilted(1.0f), 3), light_at({0, 0, -4}, 1)};
  const LightList list = select_lights(world_of(lights), clustering(1.01f), {}, 1.0f);
  ASSERT_EQ(list.maps.size(), 3u);
  EXPECT_EQ(list.center, (std::vector<uint32_t>{1, 1, 1, 3, 4}));  // the brightest is the centre
  EXPECT_EQ(list.light_id, (std::vector<uint32_t>{0, 1, 2, 3, 4}));
  EXPECT_EQ(list.maps[0].projection, frame::Projection::cascade);
  EXPECT_EQ(list.maps[0].light_count, 3u);
  EXPECT_EQ(list.map_direction_ws[0], lights[1].direction_ws);
  EXPECT_EQ(list.lights[0].direction_ws, lights[0].direction_ws);  // each keeps its own
  EXPECT_FLOAT_EQ(list.maps[0].filter_radius_m, 0.3f * 1.01f);
  EXPECT_EQ(list.maps[1].filter_radius_m, 0.0f);
  EXPECT_EQ(list.maps[2].projection, frame::Projection::cube_face);
  EXPECT_EQ(select_lights(world_of(lights), clustering(0.99f), {}, 1.0f).maps.size(), 5u);
}

TEST(LightListTest, DynamicAndUnclusteredLightsKeepMapsOfTheirOwn) {
  pack::Light lights[]{light_at({0, 0, -4}, 3), light_at({0, 0, -4.1f}, 2), light_at({0, 0, -4.2f}, 1)};
  Recipe recipe = clustering(1.0f);
  lights[0].dynamic = 1;
  EXPECT_EQ(select_lights(world_of(lights), recipe, {}, 1.0f).maps.size(), 1u);
  recipe.dynamic_lights = DynamicLights::own;
  EXPECT_EQ(select_lights(world_of(lights), recipe, {}, 1.0f).center, (std::vector<uint32_t>{0, 1, 1}));
  lights[2].unclustered = 1;
  recipe.dynamic_lights = DynamicLights::cluster;
  EXPECT_EQ(select_lights(world_of(lights), recipe, {}, 1.0f).center, (std::vector<uint32_t>{0, 0, 2}));
}

TEST(LightListTest, AGroupIsOfDirectionalLightsOrOfOthersAndOfThoseInView) {
  pack::Light lights[]{light_at({0, 0, -4}, 1), light_at({0, 0, 90}, 8), light_at({0, 0, -40}, 2),
                       sun({0, -1, 0}, 1),      sun({1, -1, 0}, 2),      light_at({0, 0, -4}, 1)};
  for (uint32_t i = 0; i < 5; ++i) lights[i].group = 1;
  const Recipe recipe = clustering(0.5f);
  const LightList list = select_lights(world_of(lights), recipe, {}, 1.0f);
  EXPECT_EQ(centers_by_light(world_of(lights), list), (std::vector<uint32_t>{2, pack::none, 2, 4, 4, 5}));
  EXPECT_EQ(list.maps[0].range_m, 37.0f);  // of 0, seen from 2
  EXPECT_EQ(select_lights(world_of(lights), {}, {}, 1.0f).maps.size(),
            5u);  // one map per light is what the recipe asks for
}

TEST(LightListTest, ARemovedLightIsInNoListAndAnAddedOneIs) {
  const pack::Light lights[]{light_at({0, 0, -4}, 3), light_at({0.1f, 0, -4}, 2), light_at({3, 0, -9}, 2)};
  World world = world_of(lights, {.lights = 1});
  world.remove_light(0);
  const LightId added = world.add_light(light_at({3.1f, 0, -9}, 5));
  for (const bool out_of_view : {false, true}) {
    const LightList list = select_lights(world, clustering(0.5f), {}, 1.0f, {.out_of_view = out_of_view});
    EXPECT_EQ(centers_by_light(world, list), (std::vector<uint32_t>{pack::none, 1, added, added}));
    EXPECT_EQ(list.lights_in_view, 3u);
    EXPECT_TRUE(list.shadowless.empty());
  }
  const std::vector<uint32_t> at_the_removed{pack::none, 0, pack::none, pack::none};
  const LightList held = select_lights(world, clustering(0.5f), {}, 1.0f, {.centers = at_the_removed});
  EXPECT_EQ(centers_by_light(world, held)[1], 1u);
}

TEST(LightListTest, LightsWithoutShadowTakeNoMap) {
  pack::Light lights[]{light_at({0, 0, -4}, 3), light_at({0, 0, -4.1f}, 2), light_at({0, 0, 90}, 8), sun({0, -1, 0}, 1),
                       light_at({0, 0, -4.2f}, 1)};
  lights[0].shadowless = lights[2].shadowless = lights[3].shadowless = 1;
  lights[0].group = lights[1].group = 1;
  lights[0].unclustered = 1;
  for (const Recipe& recipe : {Recipe{}, clustering(0.5f)}) {
    const LightList list = select_lights(world_of(lights), recipe, {}, 1.0f);
    const bool shared = recipe.select == Select::light_clusters;
    EXPECT_EQ(list.light_id, (std::vector<uint32_t>{1, 4}));
    EXPECT_EQ(list.lights_in_view, 4u);  // 2 is behind the camera
    EXPECT_EQ(list.shadowed_in_view(), 2u);
    EXPECT_EQ(list.maps.size(), 2u);  // a group's light shares with nobody else
    ASSERT_EQ(list.shadowless.size(), 2u);
    EXPECT_EQ(list.shadowless[0].position_ws, lights[0].position_ws);
    EXPECT_EQ(list.shadowless[1].type, static_cast<uint32_t>(pack::LightType::directional));
    for (const frame::FrameLight& light : list.shadowless) EXPECT_EQ(light.map, pack::none);
    EXPECT_EQ(centers_by_light(world_of(lights), list),
              (std::vector<uint32_t>{pack::none, 1, pack::none, pack::none, 4}));
    if (shared) {
      lights[1].group = 0;
      EXPECT_EQ(select_lights(world_of(lights), recipe, {}, 1.0f).center, (std::vector<uint32_t>{1, 1}));
      lights[1].group = 1;
    }
    const std::vector<uint32_t> held{4, 0, pack::none, pack::none, 4};  // 0 has no map that 1 could take
    EXPECT_EQ(select_lights(world_of(lights), recipe, {}, 1.0f, {.centers = held}).center,
              (std::vector<uint32_t>{1, 4}));
    EXPECT_EQ(select_lights(world_of(lights), recipe, {}, 1.0f, {.out_of_view = true}).shadowless.size(), 3u);
  }
}

TEST(LightListTest, AMapsLightIsAsLargeAsTheLargestOfItsLights) {
  pack::Light lights[]{light_at({0, 0, -4}, 3), light_at({0, 0, -4.1f}, 2), light_at({9, 0, -20}, 1),
                       sun({0, -1, 0}, 1)};
  const auto radii = [&](const Recipe& recipe) {
    std::vector<float> radius_m;
    for (const frame::ShadowMap& map : select_lights(world_of(lights), recipe, {}, 1.0f).maps)
      radius_m.push_back(map.filter_radius_m);
    return radius_m;
  };
  EXPECT_FALSE(select_lights(world_of(lights), {}, {}, 1.0f).has_area_lights);
  lights[1].radius_m = 0.4f, lights[2].radius_m = 0.01f, lights[3].radius_m = 0.02f;
  EXPECT_TRUE(select_lights(world_of(lights), {}, {}, 1.0f).has_area_lights);
  EXPECT_EQ(radii({}), (std::vector<float>{0.0f, 0.4f, 0.01f, 0.02f * 30.0f}));
  EXPECT_EQ(radii(clustering(0.5f)), (std::vector<float>{0.4f, 0.01f, 0.02f * 30.0f}));
  lights[1].radius_m = lights[2].radius_m = 0.0f;  // d_min's disc, shared or alone
  EXPECT_EQ(radii(clustering(0.5f)), (std::vector<float>{0.3f * 0.5f, 0.3f * 0.5f, 0.02f * 30.0f}));
}

// The first of two equals is the centre, unless the other was; numbers are those of the pack, not of what is in view.
TEST(LightListTest, StabilityClingsToThePreviousFramesCenters) {
  const pack::Light lights[]{light_at({0, 0, 90}, 1), light_at({0, 0, -4}, 2), light_at({0, 0, -4.2f}, 2)};
  Recipe recipe = clustering(0.5f);
  recipe.stability = 0.3f;
  LightList list = select_lights(world_of(lights), recipe, {}, 1.0f);
  EXPECT_EQ(centers_by_light(world_of(lights), list), (std::vector<uint32_t>{pack::none, 1, 1}));
  const std::vector<uint32_t> previous{pack::none, 2, 2}, wrong(4);
  EXPECT_EQ(select_lights(world_of(lights), recipe, {}, 1.0f, {.previous_centers = previous}).center,
            (std::vector<uint32_t>{2, 2}));
  const std::vector<uint32_t> of_one_out_of_view{0, 0, 0};
  EXPECT_EQ(select_lights(world_of(lights), recipe, {}, 1.0f, {.previous_centers = of_one_out_of_view}).center,
            (std::vector<uint32_t>{1, 1}));
  recipe.stability = 0.0f;
  EXPECT_EQ(select_lights(world_of(lights), recipe, {}, 1.0f, {.previous_centers = previous}).center,
            (std::vector<uint32_t>{1, 1}));
  EXPECT_THROW(select_lights(world_of(lights), recipe, {}, 1.0f, {.previous_centers = wrong}), std::invalid_argument);
}

// As after World::add_light(): of the lights beyond the end nothing is known, and nothing is told.
TEST(LightListTest, CentersOfAFrameBeforeALightCameAreEnough) {
  const pack::Light lights[]{light_at({0, 0, -4}, 2), light_at({0, 0, -4.2f}, 2), light_at({9, 0, -4}, 1),
                             light_at({9, 0, -4.2f}, 1)};
  Recipe recipe = clustering(0.5f);
  recipe.stability = 0.3f;
  const auto centers = [&](const SelectionInputs& inputs) {
    return centers_by_light(world_of(lights), select_lights(world_of(lights), recipe, {}, 1.0f, inputs));
  };
  const std::vector<uint32_t> before{1, 1};
  EXPECT_EQ(centers({.out_of_view = true}), (std::vector<uint32_t>{0, 0, 2, 2}));
  EXPECT_EQ(centers({.previous_centers = before, .out_of_view = true}), (std::vector<uint32_t>{1, 1, 2, 2}));
  EXPECT_EQ(centers({.centers = before, .out_of_view = true}), (std::vector<uint32_t>{1, 1, 2, 2}));
}

// Centres that are given hold whatever would be selected; C_att follows.
TEST(LightListTest, LightsTakeTheMapsTheyAreTold) {
  std::vector<pack::Light> lights(4, pack::Light{.range_m = 5.0f});
  for (uint32_t i = 0; i < 3; ++i) lights[i].position_ws = {static_cast<float>(i), 0, -4};
  lights[3].type = pack::LightType::directional;
  lights[3].direction_ws = {0, -1, 0};
  const std::vector<uint32_t> centers{2, pack::none, 2, 0};
  const LightList list = select_lights(world_of(lights), clustering(0.1f), {}, 1.0f, {.centers = centers});
  EXPECT_EQ(centers_by_light(world_of(lights), list), (std::vector<uint32_t>{2, 1, 2, 3}));
  ASSERT_EQ(list.maps.size(), 3u);
  EXPECT_FLOAT_EQ(list.maps[1].range_m, 7.0f);
  const std::vector<uint32_t> too_many(5, pack::none);
  EXPECT_THROW(select_lights(world_of(lights), clustering(0.1f), {}, 1.0f, {.centers = too_many}),
               std::invalid_argument);
}

TEST(LightListTest, AreaRadiusIsDMinOrTheMembersSpread) {
  const pack::Light lights[]{light_at({0, 0, -4}, 3), light_at({0, 0, -4.25f}, 2), light_at({4, 0, -9}, 1)};
  Recipe recipe = clustering(1.0f);
  LightList list = select_lights(world_of(lights), recipe, {}, 1.0f);
  ASSERT_EQ(list.maps.size(), 2u);
  EXPECT_FLOAT_EQ(list.maps[0].filter_radius_m, 0.3f);
  EXPECT_FLOAT_EQ(list.maps[1].filter_radius_m, 0.3f);
  recipe.area_radius = AreaRadius::spread;
  list = select_lights(world_of(lights), recipe, {}, 1.0f);
  EXPECT_FLOAT_EQ(list.maps[0].filter_radius_m, 0.6f * 0.25f);
  EXPECT_EQ(list.maps[1].filter_radius_m, 0.0f);
}

}  // namespace
}  // namespace chandelier
