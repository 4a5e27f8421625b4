// SPDX-License-Identifier: Apache-2.0
// Error searches of a world that changes, searches that run beside the frames, and how much memory one takes.
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <numeric>
#include <stop_token>
#include <thread>

#include "lights/light_list.h"
#include "lights/map_shares.h"
#include "lights/search_stopped.h"
#include "sampled_scene.h"

namespace chandelier {
namespace {

using test::from_above;

constexpr float aspect = 16.0f / 9.0f;

Recipe by_error(std::optional<uint32_t> max_maps = {}) {
  Recipe recipe;
  recipe.select = Select::error_driven;
  recipe.max_maps = max_maps;
  recipe.d_init_m = 2.0f;
  return recipe;
}

void expect_equal(const LightList& a, const LightList& b) {
  EXPECT_EQ(a.light_id, b.light_id);
  EXPECT_EQ(a.center, b.center);
  EXPECT_EQ(a.share, b.share);
}

LightList fresh(const World& world, const Recipe& recipe, const Camera& camera = from_above()) {
  Surroundings surroundings(world);
  return select_lights(world, recipe, camera, aspect, {.surroundings = &surroundings});
}

void move_light(World& world, LightId id, const glm::vec3& to) {
  pack::Light light = world.lights()[id];
  light.position_ws = to;
  world.set_light(id, light);
}

TEST(ErrorDrivenWorldTest, ForgetsItsSamplesWhenALightMoves) {
  const pack::File pack = test::divided_floor().open();
  World world(pack);
  Surroundings surroundings(world);
  const SelectionInputs inputs{.surroundings = &surroundings};
  const LightList before = select_lights(world, by_error(2), from_above(), aspect, inputs);
  EXPECT_EQ(before.center[0], before.center[1]);  // lights 0 and 1 share the left side
  move_light(world, 1, {1.5f, 1.5f, 0.5f});       // to the other side of the wall
  const LightList after = select_lights(world, by_error(2), from_above(), aspect, inputs);
  expect_equal(after, fresh(world, by_error(2)));
  const std::vector<LightId> centers = centers_by_light(world, after);
  EXPECT_NE(centers[0], centers[1]);
  EXPECT_EQ(centers[1], centers[2]);
}

TEST(ErrorDrivenWorldTest, SeesWhereInstancesStand) {
  test::Scene with_wall = test::divided_floor(), without_wall;
  without_wall.add(test::level_square(glm::vec3(0), 4),
                   without_wall.add_material(test::plain_material(glm::vec3(0.8f))));
  without_wall.lights = with_wall.lights;
  const pack::File pack = with_wall.open(), open = without_wall.open();
  World world(pack);
  const World expected(open);
  Surroundings surroundings(world);
  const SelectionInputs inputs{.surroundings = &surroundings};
  EXPECT_EQ(select_lights(world, by_error(), from_above(), aspect, inputs).maps.size(), 2u);
  world.set_transform(1, {glm::vec4(1, 0, 0, 100), glm::vec4(0, 1, 0, 0), glm::vec4(0, 0, 1, 0)});  // out of sight
  expect_equal(select_lights(world, by_error(), from_above(), aspect, inputs), fresh(expected, by_error()));
}

// Waits until the search has ended, as a window does that redraws then.
LightList when_found(const World& world, const Recipe& recipe, const Camera& camera, Surroundings& surroundings,
                     const SelectionInputs& inputs) {
  LightList list = select_lights(world, recipe, camera, aspect, inputs);
  while (list.is_provisional) {
    while (!surroundings.has_news()) std::this_thread::sleep_for(std::chrono::milliseconds(1));
    list = select_lights(world, recipe, camera, aspect, inputs);
  }
  return list;
}

TEST(ErrorDrivenWorldTest, ASearchBesideTheFramesFindsTheSame) {
  const pack::File pack = test::pillars(3).open();
  World world(pack);
  Surroundings surroundings(world);
  const SelectionInputs inputs{.surroundings = &surroundings, .search_beside_frames = true};
  Camera camera = from_above();
  for (const Recipe& recipe : {by_error(), by_error(4)}) {
    for (int step = 0; step < 3; ++step) {
      camera.eye_ws.x += 0.2f;
      if (step == 1) move_light(world, 2, {0.1f, 1, 0.1f});
      if (step == 2) world.set_transform(1, {glm::vec4(1, 0, 0, 0.5f), glm::vec4(0, 1, 0, 0), glm::vec4(0, 0, 1, 0)});
      expect_equal(when_found(world, recipe, camera, surroundings, inputs), fresh(world, recipe, camera));
    }
  }
}

// Every light in view is lit once, whole, from a map that is there.
void expect_sound(const World& world, const LightList& list) {
  std::vector<float> sums(world.lights().size(), 0.0f);
  for (size_t i = 0; i < list.lights.size(); ++i) {
    sums[list.light_id[i]] += list.share[i];
    EXPECT_TRUE(world.has_light(list.light_id[i]));
    EXPECT_TRUE(world.has_light(list.center[i]));
  }
  for (LightId id = 0; id < sums.size(); ++id) EXPECT_NEAR(sums[id], world.has_light(id) ? 1.0f : 0.0f, 1e-4f) << id;
}

TEST(ErrorDrivenWorldTest, TheLastAnswerStandsUntilTheNextIsFound) {
  const pack::File pack = test::pillars(4).open();
  World world(pack, {.lights = 1});
  Surroundings surroundings(world);
  const SelectionInputs inputs{.surroundings = &surroundings, .out_of_view = true, .search_beside_frames = true};
  Recipe clusters = by_error(5);
  clusters.select = Select::light_clusters;
  // Before there is any answer: light clusters.
  const LightList first = select_lights(world, by_error(5), from_above(), aspect, inputs);
  EXPECT_TRUE(first.is_provisional);
  EXPECT_EQ(first.center, select_lights(world, clusters, from_above(), aspect, inputs).center);
  const LightList found = when_found(world, by_error(5), from_above(), surroundings, inputs);
  EXPECT_EQ(found.maps.size(), 5u);

  // A centre is gone and a light is new: these have maps of their own, and the rest stays as it was.
  const LightId gone = found.center[0];
  world.remove_light(gone);
  const LightId added = world.add_light(test::point_light({0, 2, 0}, 5, 5));
  const LightList standing = select_lights(world, by_error(5), from_above(), aspect, inputs);
  EXPECT_TRUE(standing.is_provisional);
  expect_sound(world, standing);
  const std::vector<LightId> now = centers_by_light(world, standing);
  EXPECT_EQ(now[added], added);
  for (LightId id = 0; id < 24; ++id) {
    const auto of_light = std::find(found.light_id.begin(), found.light_id.end(), id) - found.light_id.begin();
    if (id == gone || found.share[of_light] < 1.0f) continue;
    EXPECT_EQ(now[id], found.center[of_light] == gone ? id : found.center[of_light]) << id;
  }
  const LightList next = when_found(world, by_error(5), from_above(), surroundings, inputs);
  EXPECT_EQ(next.maps.size(), 5u);
  expect_sound(world, next);
}

// One that nobody waits for ends with the surroundings.
TEST(ErrorDrivenWorldTest, ASearchIsStoppedWhenItsWorldGoes) {
  const pack::File pack = test::pillars(5).open();
  World world(pack);
  for (int i = 0; i < 5; ++i) {
    Surroundings surroundings(world);
    EXPECT_TRUE(select_lights(world, by_error(), from_above(), aspect,
                              {.surroundings = &surroundings, .search_beside_frames = true})
                    .is_provisional);
    world.set_transform(0, {glm::vec4(1, 0, 0, 0), glm::vec4(0, 1, 0, 0.01f), glm::vec4(0, 0, 1, 0)});
    select_lights(world, by_error(), from_above(), aspect,
                  {.surroundings = &surroundings, .search_beside_frames = true});
  }
}

// Camera A, B for one frame, and A again, as a window that does not rest there may have it.
TEST(ErrorDrivenWorldTest, AnExactAnswerOutlastsTheSearchOfAnotherView) {
  const pack::File pack = test::pillars(3).open();
  const World world(pack);
  Surroundings surroundings(world);
  const SelectionInputs inputs{.surroundings = &surroundings, .search_beside_frames = true};
  Camera other = from_above();
  other.eye_ws.x += 1.0f;
  const LightList exact = when_found(world, by_error(4), from_above(), surroundings, inputs);
  for (const bool has_ended : {false, true}) {  // when the camera is back at A
    EXPECT_TRUE(select_lights(world, by_error(4), other, aspect, inputs).is_provisional);
    while (has_ended && !surroundings.has_news()) std::this_thread::sleep_for(std::chrono::milliseconds(1));
    LightList back = select_lights(world, by_error(4), from_above(), aspect, inputs);
    EXPECT_FALSE(back.is_provisional);
    while (!has_ended && !surroundings.has_news()) std::this_thread::sleep_for(std::chrono::milliseconds(1));
    back = select_lights(world, by_error(4), from_above(), aspect, inputs);
    EXPECT_FALSE(back.is_provisional);
    expect_equal(back, exact);
    EXPECT_FALSE(surroundings.has_news());
  }
  expect_equal(when_found(world, by_error(4), other, surroundings, inputs), fresh(world, by_error(4), other));
}

// An instance that moves every frame. Searches go on meanwhile, each to its end.
TEST(ErrorDrivenWorldTest, AnswersComeWhileAnInstanceMovesEveryFrame) {
  constexpr uint32_t most_frames = 60000;
  const pack::File pack = test::pillars(4).open();
  World world(pack);
  Surroundings surroundings(world);
  const SelectionInputs inputs{.surroundings = &surroundings, .search_beside_frames = true};
  ASSERT_NE(fresh(world, by_error()).maps.size(), 5u);
  uint32_t frame = 0, answers = 0;
  size_t maps = 0;
  for (const uint32_t asked : {5u, 3u}) {  // the number of maps tells whose answer it is
    for (; maps != asked && frame < most_frames; ++frame) {
      const float x = 0.001f * static_cast<float>(frame % 1000);
      world.set_transform(1, {glm::vec4(1, 0, 0, x), glm::vec4(0, 1, 0, 0), glm::vec4(0, 0, 1, 0)});
      const LightList list = select_lights(world, by_error(asked), from_above(), aspect, inputs);
      EXPECT_TRUE(list.is_provisional);
      expect_sound(world, list);
      maps = list.maps.size();
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    answers += maps == asked;
  }
  EXPECT_EQ(answers, 2u);
  // When it rests, where it rests counts.
  expect_equal(when_found(world, by_error(3), from_above(), surroundings, inputs), fresh(world, by_error(3)));
}

// A frame before has no say, whatever the stability: the same is asked, and the answer is the same.
TEST(ErrorDrivenWorldTest, DependsOnNoFrameBefore) {
  const pack::File pack = test::pillars(3).open();
  const World world(pack);
  Recipe recipe = by_error();
  const LightList expected = fresh(world, recipe);
  std::vector<LightId> own(world.lights().size());
  std::iota(own.begin(), own.end(), 0u);
  Surroundings surroundings(world);
  SelectionInputs inputs{.surroundings = &surroundings, .previous_centers = own};
  recipe.stability = 0.9f;
  expect_equal(select_lights(world, recipe, from_above(), aspect, inputs), expected);
  inputs.search_beside_frames = true;
  expect_equal(when_found(world, recipe, from_above(), surroundings, inputs), expected);
  const std::vector<LightId> of_answer = centers_by_light(world, expected);
  inputs.previous_centers = of_answer;
  const LightList next = select_lights(world, recipe, from_above(), aspect, inputs);
  EXPECT_FALSE(next.is_provisional);
  expect_equal(next, expected);
}

// Whatever takes long ends when it is told to.
TEST(SearchStoppedTest, EveryLongStepLooks) {
  const test::Scene scene = test::pillars(3);
  const test::Sampled s(scene, {.columns = 16, .rows = 9});
  const auto count = static_cast<uint32_t>(s.samples->lights().size());
  const ErrorLadder ladder(*s.samples, DynamicLights::cluster);
  std::vector<uint32_t> own(count);
  std::iota(own.begin(), own.end(), 0u);
  std::vector<MapMember> members;
  for (const uint32_t light : own) members.push_back({light, light, 0.0f});
  std::stop_source source;
  source.request_stop();
  const std::stop_token stop = source.get_token();
  EXPECT_THROW(LightSamples(s.sampled, {}, from_above(), aspect, {}, stop), SearchStopped);  // places points alone
  EXPECT_THROW(ErrorLadder(*s.samples, DynamicLights::cluster, {}, stop), SearchStopped);
  EXPECT_THROW(ladder.with_at_most(3, stop), SearchStopped);
  EXPECT_THROW(ladder.within(0.01, *s.samples, test::hard, stop), SearchStopped);
  EXPECT_THROW(share_out(*s.samples, own, std::vector<std::vector<uint32_t>>(count), stop), SearchStopped);
  EXPECT_THROW(estimated_rmse(*s.samples, members, test::hard, stop), SearchStopped);
  EXPECT_LE(ladder.with_at_most(3).size(), size_t{3} * count);  // and can be asked again
}

// As many points as ever up to 1,302 lights; then fewer, down to 9 rows.
TEST(SampleGridTest, IsCoarserForManyLightsSoThatMemoryIsBounded) {
  const auto points = [](size_t lights) {
    const SampleSettings grid = sample_grid(lights, {});
    return size_t{grid.columns} * grid.rows;
  };
  EXPECT_EQ(points(1), 192u * 108u);
  for (const size_t lights : {size_t{130}, size_t{500}, size_t{1302}}) EXPECT_EQ(points(lights), 64u * 36u) << lights;
  for (const size_t lights : {size_t{1303}, size_t{3000}, size_t{10000}, size_t{20833}})
    EXPECT_LE(lights * points(lights), 3000000u) << lights;
  EXPECT_EQ(points(20834), 16u * 9u);
  EXPECT_EQ(points(1000000), 16u * 9u);

  constexpr size_t count = 4000;
  test::Scene scene;
  scene.add(test::level_square(glm::vec3(0), 40), scene.add_material(test::plain_material(glm::vec3(0.8f))));
  for (size_t i = 0; i < count; ++i)
    scene.lights.push_back(test::point_light({0.001f * static_cast<float>(i) - 2.0f, 3, 0}, 1, 1000));
  const test::Sampled s(scene, sample_grid(count, {}));
  size_t entries = 0;
  for (uint32_t light = 0; light < count; ++light) entries += s.samples->contributions(light).size();
  EXPECT_EQ(entries, count * s.samples->points().size());  // all lights reach all points
  EXPECT_LE(entries, 3000000u);
}

// A full copy of every selection, and every light as a candidate of every other, would be 2 · 1500² entries.
TEST(ErrorLadderTest, KeepsMemoryInProportionToTheLights) {
  constexpr uint32_t count = 1500;
  test::Scene scene = test::pillars(6);
  const pack::Light lamp = scene.lights[0];
  scene.lights.clear();
  for (uint32_t i = 0; i < count; ++i) {
    scene.lights.push_back(lamp);
    scene.lights.back().range_m = 1.5f;
    scene.lights.back().position_ws = {-3.9f + 0.2f * static_cast<float>(i % 40), 1.0f,
                                       -3.9f + 0.2f * static_cast<float>(i / 40)};
  }
  const test::Sampled s(scene, {.columns = 16, .rows = 9});
  const ErrorLadder ladder(*s.samples, DynamicLights::cluster);
  EXPECT_GE(ladder.entries(), size_t{count} - ladder.fewest_maps());  // each map but the last was taken away once
  EXPECT_LE(ladder.entries(), ErrorLadder::most_entries_per_light * count);
  EXPECT_LE(ladder.candidate_entries(), size_t{64} * count);
  for (const uint32_t maps : {1u, 7u, 100u, 1000u, count}) {
    std::vector<bool> is_center(count);
    for (const MapMember& m : ladder.with_at_most(maps)) is_center[m.center] = true;
    EXPECT_LE(std::count(is_center.begin(), is_center.end(), true), std::max(maps, ladder.fewest_maps()));
  }
}

// Rays meet a moved instance where it is, and not where it was.
TEST(PackRaysTest, FollowMovedInstances) {
  const auto scene_with = [](const glm::mat4& place) {
    test::Scene scene;
    const uint32_t white = scene.add_material(test::plain_material(glm::vec3(0.8f)));
    scene.add(test::level_square(glm::vec3(0), 4), white);
    scene.add(test::sphere({0, 1, 0}, 0.7f, 12), white, place);
    return scene;
  };
  glm::mat4 away(0.8f, 0, 0.6f, 0, 0, 1.5f, 0, 0, -0.6f, 0, 0.8f, 0, 2, 0.25f, -1, 1);
  const glm::mat4 flat(1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 1, 0, -1, 0.5f, 0, 1);
  const pack::File pack = scene_with(glm::mat4(1)).open();
  rays::PackRays moved(pack.view());
  for (const glm::mat4& place : {away, flat, glm::mat4(1), away}) {
    const glm::mat4 t = glm::transpose(place);
    moved.set_transform(1, {t[0], t[1], t[2]});
    const pack::File expected_pack = scene_with(place).open();
    const rays::PackRays expected(expected_pack.view());
    uint32_t met = 0;
    for (int i = 0; i < 2000; ++i) {
      const glm::vec3 from(0.3f * static_cast<float>(i % 20) - 3, 4, 0.06f * static_cast<float>(i / 20) - 3);
      const auto a = moved.first_hit(from, {0.1f, -1, 0.05f}, 10), b = expected.first_hit(from, {0.1f, -1, 0.05f}, 10);
      ASSERT_EQ(a.has_value(), b.has_value());
      if (!a) continue;
      met += a->instance == 1;
      EXPECT_EQ(a->instance, b->instance);
      EXPECT_NEAR(a->distance_m, b->distance_m, 1e-5f);
    }
    EXPECT_GT(met, 50u);
  }
}

}  // namespace
}  // namespace chandelier
