// SPDX-License-Identifier: Apache-2.0
// What can change of a pack: ids, versions, room, errors, and the boxes of what has moved.
#include "world/world.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "../gpu/scene_builder.h"
#include "light_near.h"

namespace chandelier {
namespace {

using Rows = std::array<glm::vec4, 3>;

Rows rows_of(const glm::mat4& m) {
  const glm::mat4 t = glm::transpose(m);
  return {t[0], t[1], t[2]};
}

Rows shifted(const glm::vec3& by) {
  return {glm::vec4(1, 0, 0, by.x), glm::vec4(0, 1, 0, by.y), glm::vec4(0, 0, 1, by.z)};
}

// A floor, a box of 1 m on it, and three lamps.
test::Scene small_scene() {
  test::Scene scene;
  const uint32_t white = scene.add_material(test::plain_material(glm::vec3(0.8f)));
  scene.add(test::level_square(glm::vec3(0), 4), white);
  scene.add(test::box({0, 0, 0}, {1, 1, 1}), white);
  for (const float x : {-2.0f, 0.0f, 2.0f}) scene.lights.push_back(test::point_light({x, 2, 0}, 10, 5));
  return scene;
}

class WorldTest : public testing::Test {
 protected:
  pack::File pack_ = small_scene().open();
  World world_{pack_, {.lights = 2}};

  // What an action throws, or nothing.
  template <typename Action>
  static std::string error_of(Action action) {
    try {
      action();
    } catch (const WorldError& error) {
      return error.what();
    }
    return {};
  }
};

TEST_F(WorldTest, StartsAsThePackHasIt) {
  ASSERT_EQ(world_.lights().size(), 3u);
  EXPECT_EQ(world_.light_count(), 3u);
  for (LightId id = 0; id < 3; ++id) {
    EXPECT_TRUE(world_.has_light(id));
    EXPECT_EQ(world_.lights()[id].position_ws, pack_.view().lights[id].position_ws);
    EXPECT_EQ(world_.light_version(id), 0u);
  }
  EXPECT_FALSE(world_.has_light(3));
  EXPECT_EQ(world_.version(), 0u);
  EXPECT_TRUE(world_.lights_changed_since(0).empty());
  EXPECT_TRUE(world_.instances_changed_since(0).empty());
  EXPECT_EQ(world_.bounds().min_ws, pack_.view().bake_info->bounds_min_ws);
  EXPECT_EQ(world_.bounds().max_ws, pack_.view().bake_info->bounds_max_ws);
}

TEST_F(WorldTest, TellsWhatChangedSinceWhen) {
  pack::Light light = world_.lights()[1];
  light.intensity = 3;
  world_.set_light(1, light);
  const Version first = world_.version();
  EXPECT_GT(first, 0u);
  EXPECT_EQ(world_.light_version(1), first);
  EXPECT_EQ(world_.lights_version(), first);
  EXPECT_EQ(world_.instances_version(), 0u);
  EXPECT_EQ(world_.light_version(0), 0u);

  world_.set_transform(1, shifted({1, 0, 0}));
  world_.set_light(2, light);
  EXPECT_EQ(world_.lights_changed_since(first), std::vector<LightId>{2});
  EXPECT_EQ(world_.lights_changed_since(0), (std::vector<LightId>{1, 2}));
  EXPECT_EQ(world_.instances_changed_since(first), std::vector<InstanceId>{1});
  EXPECT_TRUE(world_.lights_changed_since(world_.version()).empty());
  EXPECT_EQ(world_.lights()[1].intensity, 3.0f);
}

TEST_F(WorldTest, KeepsIdsWhenLightsComeAndGo) {
  world_.remove_light(1);
  EXPECT_FALSE(world_.has_light(1));
  EXPECT_TRUE(world_.has_light(2));
  EXPECT_EQ(world_.light_count(), 2u);
  EXPECT_EQ(world_.lights()[1].intensity, 0.0f);
  EXPECT_EQ(world_.lights_changed_since(0), std::vector<LightId>{1});

  const pack::Light lamp = test::point_light({0, 3, 0}, 7, 4);
  EXPECT_EQ(world_.add_light(lamp), 3u);
  EXPECT_EQ(world_.add_light(lamp), 4u);
  EXPECT_EQ(world_.light_count(), 4u);
  EXPECT_EQ(world_.lights()[3].intensity, 7.0f);
  EXPECT_EQ(error_of([&] { world_.add_light(lamp); }), "light 5: there is no room; the world was made for 5 lights");
  world_.set_light(1, lamp);  // comes back
  EXPECT_TRUE(world_.has_light(1));
  EXPECT_EQ(world_.light_count(), 5u);
}

TEST_F(WorldTest, ErrorsNameTheLightAndTheValue) {
  const auto set = [&](LightId id, auto change) {
    pack::Light light = world_.lights()[1];
    change(light);
    return error_of([&] { world_.set_light(id, light); });
  };
  EXPECT_EQ(set(7, [](pack::Light&) {}), "light 7: there is none; ids are below 3");
  EXPECT_EQ(set(1, [](pack::Light& l) { l.priority = 256; }), "light 1.priority: 256 is above 255");
  EXPECT_EQ(set(1, [](pack::Light& l) { l.intensity = -3; }), "light 1.intensity: -3 is below 0");
  EXPECT_EQ(set(1, [](pack::Light& l) { l.direction_ws = {0, -2, 0}; }), "light 1.direction_ws: length 2 is not 1");
  EXPECT_NE(set(1, [](pack::Light& l) { l.position_ws.y = NAN; }).find("light 1.position_ws.y: nan"),
            std::string::npos);
  EXPECT_EQ(error_of([&] { world_.remove_light(9); }), "light 9: there is none to remove");
  world_.remove_light(2);
  EXPECT_EQ(error_of([&] { world_.remove_light(2); }), "light 2: there is none to remove");

  pack::Light bad = world_.lights()[0];
  bad.radius_m = -1;
  const Version before = world_.version();
  EXPECT_EQ(error_of([&] { world_.add_light(bad); }), "light 3.radius_m: -1 is below 0");
  EXPECT_EQ(world_.version(), before);
  EXPECT_EQ(world_.lights().size(), 3u);  // nothing was added
}

TEST_F(WorldTest, ADirectionalLightHasNoPlace) {
  pack::Light sun = test::directional_light({0, -1, 0}, 2);
  sun.position_ws = {1, 2, 3};
  sun.range_m = 4;
  world_.set_light(0, sun);
  EXPECT_EQ(world_.lights()[0].position_ws, glm::vec3(0));
  EXPECT_EQ(world_.lights()[0].range_m, 0.0f);
}

// Boxes hold all triangles where they are now.
TEST_F(WorldTest, BoxesFollowAMovedInstance) {
  const glm::mat4 turn(0.36f, 0.48f, -0.8f, 0, -0.8f, 0.6f, 0, 0, 0.48f, 0.64f, 0.6f, 0, 3, 4, 5, 1);
  const auto floor = world_.batches_of(0);
  const pack::BatchInstance floor_before = world_.batch_instances()[floor[0]];
  world_.set_transform(1, rows_of(turn));
  ASSERT_FALSE(world_.batches_of(1).empty());
  for (const uint32_t number : world_.batches_of(1)) {
    const pack::BatchInstance& draw = world_.batch_instances()[number];
    EXPECT_EQ(draw.instance, 1u);
    const pack::Batch& batch = pack_.view().batches[draw.batch];
    for (uint32_t i = batch.first_index; i < batch.first_index + batch.index_count; ++i) {
      const glm::vec3 p(turn * glm::vec4(pack_.view().positions[pack_.view().indices[i].vertex].position_ls, 1));
      EXPECT_TRUE(glm::all(glm::lessThanEqual(draw.bounds_min_ws - 1e-6f, p)));
      EXPECT_TRUE(glm::all(glm::lessThanEqual(p, draw.bounds_max_ws + 1e-6f)));
    }
    EXPECT_LT(glm::distance(draw.bounds_min_ws, draw.bounds_max_ws), 3.1f);  // of a box turned on its corner
    EXPECT_GE(world_.bounds().max_ws.z, draw.bounds_max_ws.z);
  }
  EXPECT_EQ(world_.batch_instances()[floor[0]].bounds_max_ws, floor_before.bounds_max_ws);
  world_.set_transform(1, shifted({0, 0, 0}));
  EXPECT_EQ(world_.bounds().max_ws, pack_.view().bake_info->bounds_max_ws);
}

TEST_F(WorldTest, ErrorsNameTheInstanceAndTheValue) {
  EXPECT_EQ(error_of([&] {
              world_.set_transform(5, shifted({0, 0, 0}));
            }),
            "instance 5: there is none; ids are below 2");
  Rows rows = shifted({0, 0, 0});
  rows[1].z = INFINITY;
  EXPECT_EQ(error_of([&] { world_.set_transform(1, rows); }),
            "instance 1.world_from_local: row 1 has a number that is not finite (inf)");
  rows = shifted({0, 0, 0});
  rows[0].x = -1;
  EXPECT_NE(error_of([&] { world_.set_transform(1, rows); }).find("instance 1.world_from_local: mirrors"),
            std::string::npos);
  EXPECT_EQ(world_.version(), 0u);
}

// As the baker measures it: the near plane of its shadow map must lie before what is nearest.
TEST_F(WorldTest, ALightThatMovesKnowsItsNearestCaster) {
  pack::Light lamp = world_.lights()[0];
  lamp.position_ws = {0.5f, 1.002f, 0.5f};  // above the box
  world_.set_light(0, lamp);
  EXPECT_NEAR(world_.lights()[0].nearest_caster_m, 0.002f, 1e-6f);
  lamp.position_ws.y = 2;
  world_.set_light(0, lamp);
  EXPECT_EQ(pack::shadow_near_m(world_.lights()[0]), pack::most_shadow_near_m);
  world_.set_transform(1, shifted({0, 0.997f, 0}));
  EXPECT_EQ(pack::shadow_near_m(world_.lights()[0]), pack::most_shadow_near_m);  // as documented
  lamp.position_ws.x += 0.01f;
  world_.set_light(0, lamp);
  EXPECT_NEAR(world_.lights()[0].nearest_caster_m, 0.003f, 1e-6f);
}

}  // namespace
}  // namespace chandelier
