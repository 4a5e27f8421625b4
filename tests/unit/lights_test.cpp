// SPDX-License-Identifier: Apache-2.0
// Cameras, which lights are in view, recipes, and the list of lights that a frame works through.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "frame/recipe.h"
#include "lights/light_list.h"
#include "world_of.h"

namespace chandelier {
namespace {

using test::world_of;

using Random = std::mt19937;
float uniform(Random& random, float from, float to) {
  return from + (to - from) * static_cast<float>(random() >> 8) * 0x1p-24f;
}
glm::vec3 uniform3(Random& random, float from, float to) {
  const float x = uniform(random, from, to), y = uniform(random, from, to);
  return {x, y, uniform(random, from, to)};
}

Camera random_camera(Random& random) {
  Camera camera;
  camera.eye_ws = uniform3(random, -3, 3);
  camera.forward_ws = glm::normalize(uniform3(random, -1, 1) + glm::vec3(0, 0, 1e-3f));
  camera.yfov_rad = uniform(random, 0.3f, 2.2f);
  camera.znear_m = uniform(random, 0.01f, 0.5f);
  return camera;
}

TEST(CameraTest, ClipSpaceHasXRightYDownAndReversedDepth) {
  Camera camera;
  camera.eye_ws = {1, 2, 3};
  camera.forward_ws = {0, 0, -1};
  camera.yfov_rad = 2.0f * std::atan(0.5f);
  camera.znear_m = 0.1f;
  const glm::mat4 clip = clip_from_eye(camera, 2.0f);
  const auto project = [&](const glm::vec3& offset) {
    const glm::vec4 p = clip * glm::vec4(offset, 1.0f);
    return glm::vec3(p) / p.w;
  };
  // At 10 m the picture reaches 5 m up and 10 m to the right.
  EXPECT_NEAR(glm::distance(project({0, 0, -10}), {0, 0, 0.01f}), 0, 1e-5);
  EXPECT_NEAR(glm::distance(project({10, 0, -10}), {1, 0, 0.01f}), 0, 1e-5);
  EXPECT_NEAR(glm::distance(project({0, 5, -10}), {0, -1, 0.01f}), 0, 1e-5);
  EXPECT_NEAR(project({0, 0, -0.1f}).z, 1, 1e-5);
}

// Points are inside all planes exactly when they project into the picture.
TEST(CameraTest, FrustumPlanesAgreeWithTheProjection) {
  Random random(1);
  uint32_t inside = 0;
  for (int i = 0; i < 20000; ++i) {
    const Camera camera = random_camera(random);
    const float aspect = uniform(random, 0.4f, 2.5f);
    const glm::vec3 p = camera.eye_ws + uniform3(random, -5, 5);
    const glm::vec4 clip = clip_from_eye(camera, aspect) * glm::vec4(p - camera.eye_ws, 1.0f);
    const float margin = std::min({clip.w - std::abs(clip.x), clip.w - std::abs(clip.y), clip.w - clip.z});
    if (std::abs(margin) < 1e-3f) continue;  // too near to a side to say
    EXPECT_EQ(intersects(frustum_planes(camera, aspect), p, 0.0f), margin > 0.0f);
    inside += margin > 0.0f;
  }
  EXPECT_GT(inside, 1000u);
}

// By brute force: a sphere with any sampled point in view must be kept; one far from every side must not.
TEST(CameraTest, SpheresThatReachIntoViewAreKept) {
  Random random(2);
  uint32_t seen = 0, rejected = 0;
  for (int i = 0; i < 2000; ++i) {
    const Camera camera = random_camera(random);
    const FrustumPlanes planes = frustum_planes(camera, 1.5f);
    const glm::vec3 center = camera.eye_ws + uniform3(random, -8, 8);
    const float radius = uniform(random, 0.1f, 3.0f);
    bool any = false;
    for (int k = 0; k < 300 && !any; ++k) {
      glm::vec3 offset;
      do offset = uniform3(random, -1, 1);
      while (glm::dot(offset, offset) > 1.0f);
      any = intersects(planes, center + radius * offset, 0.0f);
    }
    EXPECT_TRUE(!any || intersects(planes, center, radius));
    seen += any;
    rejected += !intersects(planes, center, radius);
  }
  EXPECT_GT(seen, 300u);
  EXPECT_GT(rejected, 300u);
}

TEST(CameraTest, UpAlongForwardIsReplaced) {
  Camera camera;
  camera.forward_ws = {0, -1, 0};
  const CameraAxes axes = axes_of(camera);
  EXPECT_NEAR(glm::length(axes.right), 1.0f, 1e-6);
  EXPECT_NEAR(glm::length(axes.up), 1.0f, 1e-6);
  EXPECT_NEAR(glm::dot(axes.right, axes.forward), 0.0f, 1e-6);
  EXPECT_NEAR(glm::dot(glm::cross(axes.right, axes.up), -axes.forward), 1.0f, 1e-6);
}

pack::Light light_at(const glm::vec3& position_ws, float range_m, pack::LightType type = pack::LightType::point) {
  pack::Light light;
  light.position_ws = position_ws;
  light.range_m = range_m;
  light.direction_ws = {0, -1, 0};
  light.intensity = 2.0f;
  light.color = {1.0f, 0.5f, 0.25f};
  light.type = type;
  light.inner_cone_cos = type == pack::LightType::spot ? 0.9f : 1.0f;
  light.outer_cone_cos = type == pack::LightType::spot ? 0.8f : -1.0f;
  return light;
}

// A camera at the origin that looks along -z.
TEST(LightListTest, PerLightKeepsWhatIsInViewInThePacksOrder) {
  const pack::Light lights[]{light_at({0, 0, -5}, 1), light_at({0, 0, 5}, 1), light_at({0, 0, 5}, 7),
                             light_at({0, 0, 0}, 0, pack::LightType::directional),
                             light_at({1, 0, -3}, 2, pack::LightType::spot)};
  const LightList list = select_lights(world_of(lights), {}, {}, 1.0f);
  EXPECT_EQ(list.light_id, (std::vector<uint32_t>{0, 2, 3, 4}));
  ASSERT_EQ(list.maps.size(), 4u);
  for (uint32_t i = 0; i < 4; ++i) {
    EXPECT_EQ(list.maps[i].first_light, i);
    EXPECT_EQ(list.maps[i].light_count, 1u);
    EXPECT_EQ(list.maps[i].center_ws, lights[list.light_id[i]].position_ws);
    EXPECT_EQ(list.maps[i].range_m, lights[list.light_id[i]].range_m);
    EXPECT_EQ(list.maps[i].filter_radius_m, 0.0f);
    EXPECT_EQ(list.maps[i].projection == frame::Projection::cascade, i == 2);
    EXPECT_EQ(list.lights[i].radiant, glm::vec3(2.0f, 1.0f, 0.5f));
  }
  // KHR_lights_punctual's cone: 1 at the inner angle, 0 at the outer.
  EXPECT_NEAR(0.9f * list.lights[3].cone_scale + list.lights[3].cone_offset, 1.0f, 1e-5);
  EXPECT_NEAR(0.8f * list.lights[3].cone_scale + list.lights[3].cone_offset, 0.0f, 1e-5);
}

TEST(LightListTest, LightClustersKeepTheirLightsTogether) {
  std::vector<pack::Light> lights;
  Random random(3);
  for (int i = 0; i < 60; ++i) {
    const auto type =
        i % 10 == 4 ? pack::LightType::directional : (i % 3 ? pack::LightType::point : pack::LightType::spot);
    lights.push_back(light_at(glm::vec3(0, 0, -12) + uniform3(random, -5, 5), uniform(random, 1, 4), type));
  }
  Recipe recipe;
  recipe.select = Select::light_clusters;
  recipe.filter = Filter::pcf;
  recipe.d_init_m = 2.0f;
  const LightList list = select_lights(world_of(lights), recipe, {}, 1.0f);
  ASSERT_LT(list.maps.size(), list.lights.size());
  std::vector<bool> met(lights.size(), false);
  uint32_t next = 0;
  for (const frame::ShadowMap& map : list.maps) {
    EXPECT_EQ(map.first_light, next);
    EXPECT_GE(map.light_count, 1u);
    next += map.light_count;
    ASSERT_LE(next, list.lights.size());
    for (uint32_t i = map.first_light; i < next; ++i) {
      const frame::FrameLight& light = list.lights[i];
      EXPECT_FALSE(met[list.light_id[i]]);
      met[list.light_id[i]] = true;
      EXPECT_EQ(map.projection == frame::Projection::cascade,
                light.type == static_cast<uint32_t>(pack::LightType::directional));
      if (map.projection == frame::Projection::cascade) continue;
      EXPECT_LE(glm::distance(light.position_ws, map.center_ws) + light.range_m, map.range_m * 1.000001f);
      EXPECT_GE(map.filter_radius_m, 0.3f * recipe.d_init_m);
    }
  }
  EXPECT_EQ(next, list.lights.size());
}

TEST(LightListTest, ClustersOfOneLightEachAreTheReferencesList) {
  std::vector<pack::Light> lights;
  Random random(4);
  for (int i = 0; i < 40; ++i)
    lights.push_back(light_at(glm::vec3(0, 0, -9) + uniform3(random, -5, 5), uniform(random, 1, 4)));
  lights.push_back(lights[3]);  // two lights in one place share a map even so
  Recipe recipe;
  const LightList reference = select_lights(world_of(lights), recipe, {}, 1.0f);
  recipe.select = Select::light_clusters;
  recipe.d_init_m = 0.0f;
  const LightList clustered = select_lights(world_of(lights), recipe, {}, 1.0f);
  EXPECT_EQ(clustered.lights.size(), reference.lights.size());
  EXPECT_EQ(clustered.maps.size(), reference.maps.size() - 1);
  for (const frame::ShadowMap& map : clustered.maps) EXPECT_EQ(map.filter_radius_m, 0.0f);
}

TEST(RecipeTest, EveryAnswerCanBeSetByItsName) {
  for (size_t stage = 0; stage < stage_choices().size(); ++stage) {
    for (const auto& [name, meaning] : stage_choices()[stage].answers) {
      Recipe recipe;
      EXPECT_TRUE(set_answer(recipe, stage, name)) << name;
      EXPECT_EQ(answer(recipe, stage), name);
    }
    Recipe recipe;
    EXPECT_FALSE(set_answer(recipe, stage, "no such answer"));
  }
}

TEST(RecipeTest, ValuesWithoutANameAreRefused) {
  for (size_t stage = 0; stage < stage_choices().size(); ++stage) {
    Recipe recipe;
    with_answer(recipe, stage, [](auto& value) { value = static_cast<std::remove_reference_t<decltype(value)>>(77); });
    EXPECT_EQ(refusal(recipe), std::string(stage_choices()[stage].stage) + ": there is no answer of number 77");
    EXPECT_EQ(answer(recipe, stage), "?");
  }
  Recipe recipe;
  recipe.walls = static_cast<WallTest>(3);
  EXPECT_EQ(refusal(recipe), "walls: there is no answer of number 3");
}

TEST(RecipeTest, PresetsCanBeRendered) {
  ASSERT_GE(presets().size(), 2u);
  for (const Preset& preset : presets()) EXPECT_EQ(refusal(preset.recipe), std::nullopt) << preset.name;
}

TEST(RecipeTest, RefusalsNameTheSetting) {
  const auto reason = [](auto change) {
    Recipe recipe;
    change(recipe);
    return refusal(recipe).value_or("");
  };
  const auto has = [](const std::string& text, const char* word) { return text.find(word) != std::string::npos; };
  const float nan = std::numeric_limits<float>::quiet_NaN();
  EXPECT_TRUE(has(reason([](Recipe& r) { r.d_init_m = -0.1f; }), "d-init"));
  EXPECT_TRUE(has(reason([&](Recipe& r) { r.d_init_m = nan; }), "d-init"));
  EXPECT_TRUE(has(reason([](Recipe& r) { r.z_far_m = 0.0f; }), "z-far"));
  EXPECT_TRUE(has(reason([&](Recipe& r) { r.z_far_m = nan; }), "z-far"));
  EXPECT_TRUE(has(reason([](Recipe& r) { r.stability = 1.0f; }), "stability"));
  EXPECT_TRUE(has(reason([&](Recipe& r) { r.stability = nan; }), "stability"));
  EXPECT_TRUE(has(reason([](Recipe& r) { r.face_size_px = 15; }), "face-size"));
  EXPECT_TRUE(has(reason([](Recipe& r) { r.face_size_px = 16385; }), "face-size"));
  const std::string hard = reason([](Recipe& r) { r.select = Select::light_clusters; });
  EXPECT_TRUE(has(hard, "light-clusters") && has(hard, "hard") && has(hard, "pcf")) << hard;
  EXPECT_EQ(hard.find('\n'), std::string::npos);
  EXPECT_EQ(reason([](Recipe& r) {
              r.select = Select::light_clusters;
              r.d_init_m = 0.0f;
            }),
            "");
  EXPECT_EQ(reason([](Recipe& r) { r.face_size_px = 16; }), "");
}

}  // namespace
}  // namespace chandelier
