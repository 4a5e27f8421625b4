// SPDX-License-Identifier: Apache-2.0
// The audit of lights: which mistakes it names, and what it leaves in peace.
#include "bake/light_audit.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <random>
#include <span>

#include "bake/light_rays.h"
#include "bake/lights.h"
#include "gltf_builder.h"

namespace chandelier::baker::test {
namespace {

constexpr float watt_cd = 54.3514131f;  // 683 / 4π: what one watt is in Blender's standard export

/// A pack of boxes, one batch each, and a scene of lights.
struct Stage {
  Scene scene;
  pack::Contents pack;

  Stage() {
    for (const bool masked : {false, true}) {
      for (const bool double_sided : {false, true}) {
        pack::Material material;
        material.alpha_mode = masked ? pack::AlphaMode::mask : pack::AlphaMode::opaque;
        material.double_sided = double_sided;
        pack.materials.push_back(material);
      }
    }
  }

  struct Look {
    bool closed = true, inward = false, double_sided = false, masked = false;
    glm::vec3 mirror{1};
    bool open_top = false;
  };

  void add_box(const glm::vec3& low, const glm::vec3& high) { add_box(low, high, Look{}); }

  void add_box(const glm::vec3& low, const glm::vec3& high, const Look& look) {
    const auto first_vertex = static_cast<uint32_t>(pack.positions.size());
    const auto first_index = static_cast<uint32_t>(pack.indices.size());
    for (int i = 0; i < 8; ++i) {
      const glm::vec3 corner(i & 1 ? high.x : low.x, i & 2 ? high.y : low.y, i & 4 ? high.z : low.z);
      pack.positions.push_back({corner * look.mirror});  // placed by a matrix that mirrors back
    }
    // Outwards, seen in the world; +y last.
    const int faces[6][4] = {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}};
    for (const auto& face : std::span(faces).first(look.open_top ? 5 : 6)) {
      for (int corner : {0, 1, 2, 0, 2, 3}) {
        const int at = look.inward ? 3 - corner : corner;
        pack.indices.push_back({first_vertex + static_cast<uint32_t>(face[at])});
      }
    }
    pack::Batch batch;
    batch.first_index = first_index;
    batch.index_count = static_cast<uint32_t>(pack.indices.size()) - first_index;
    batch.material = (look.masked ? 2u : 0u) + (look.double_sided ? 1u : 0u);
    batch.closed = look.closed;
    pack::Instance instance;
    for (int axis = 0; axis < 3; ++axis) instance.world_from_local[axis][axis] = look.mirror[axis];
    const auto number = static_cast<uint32_t>(pack.batches.size());
    pack.batches.push_back(batch);
    pack.instances.push_back(instance);
    pack.batch_instances.push_back({low, number, high, number});
  }

  Light& add_light(const glm::vec3& position, float intensity = 50) {
    Light light;
    light.name = "lamp " + std::to_string(scene.lights.size());
    light.position_ws = glm::dvec3(position);
    light.intensity = intensity;
    scene.lights.push_back(light);
    return scene.lights.back();
  }

  /// A room of 10 × 4 × 10 m whose walls look inwards.
  void add_room() { add_box({-5, 0, -5}, {5, 4, 5}, {.closed = false, .inward = true}); }

  std::vector<std::string> audit() {
    Warnings warnings;
    PassReport pass;
    Strings strings(pack.strings);
    pack.lights.clear();
    make_lights(scene, 0.05f, strings, pack);
    audit_lights(scene, pack, pass, warnings);
    EXPECT_EQ(pass.counts.size(), warnings.lines().size());
    return warnings.lines();
  }
};

/// Exactly one warning, with these words in it.
void expect_one(Stage& stage, const std::string& words) {
  const std::vector<std::string> lines = stage.audit();
  ASSERT_EQ(lines.size(), 1u) << testing::PrintToString(lines);
  EXPECT_NE(lines[0].find(words), std::string::npos) << lines[0];
}

void expect_peace(Stage& stage) {
  EXPECT_EQ(stage.audit(), std::vector<std::string>());
}

TEST(LightAudit, LeavesALitRoomInPeace) {
  Stage stage;
  stage.add_room();
  for (const float x : {-3.0f, 0.0f, 3.0f}) stage.add_light({x, 3, 0}, 40 + x);
  expect_peace(stage);
  Stage().audit();  // nor has it anything to say of nothing
}

TEST(LightAudit, NamesLightsThatAllHaveAnExportersDefault) {
  for (const float intensity : {1.0f, 10 * watt_cd, 1000 * watt_cd, 10 / 12.5663706f, 1000.0f}) {
    Stage stage;
    for (const float x : {-300.0f, 0.0f, 300.0f}) stage.add_light({x, 30, 0}, intensity);
    expect_one(stage, "all 3 are white with " + to_text(intensity) + " cd");
  }
}

TEST(LightAudit, LeavesDefaultsInPeaceWhereAnythingWasSet) {
  const std::vector<std::function<void(Light&)>> touches = {
      [](Light& light) { light.intensity = 1.5f; },
      [](Light& light) {
        light.color = {1, 0.9f, 0.8f};
      },
      [](Light& light) { light.range_m = 20; },
  };
  for (const auto& touch : touches) {
    Stage stage;
    for (const float x : {-3.0f, 0.0f, 3.0f}) stage.add_light({x, 3, 0}, 1);
    touch(stage.scene.lights[1]);
    expect_peace(stage);
  }
  Stage same;  // all the same, but nobody's default
  for (const float x : {-3.0f, 0.0f, 3.0f}) same.add_light({x, 3, 0}, 25);
  expect_peace(same);
  Stage one;
  one.add_light({0, 3, 0}, 1);
  expect_peace(one);
}

TEST(LightAudit, NamesMixedUnitsByTheirPower) {
  const std::pair<float, const char*> mixups[] = {
      {683 * watt_cd, "683 times too bright"},        {683, "12.6 times too bright"},
      {watt_cd / 12.5663706f, "12.6 times too dark"}, {1, "54 times too dark"},
      {1 / 12.5663706f, "683 times too dark"},
  };
  for (const auto& [candela_per_watt, words] : mixups) {
    Stage stage;
    stage.add_light({0, 3, 0}, 60 * watt_cd).power_w = 60;
    stage.add_light({1, 3, 0}, 40 * candela_per_watt).power_w = 40;
    stage.add_light({2, 3, 0}, 800).power_w = 60;  // a lamp with an efficacy of its own
    expect_one(stage, words);
    EXPECT_NE(stage.audit()[0].find("(lamp 1)"), std::string::npos);
  }
}

TEST(LightAudit, NamesAFewLights683TimesAsBrightAsTheOthers) {
  Stage stage;
  stage.add_room();
  for (int i = 0; i < 9; ++i) stage.add_light({i - 4, 3, i % 3 - 1}, 40.0f + 2.0f * static_cast<float>(i));
  stage.scene.lights[4].intensity *= 683;
  expect_one(stage, "about 683 times as bright as the other lights: were watts turned to lumens twice? (lamp 4)");
}

TEST(LightAudit, LeavesFloodlightsInPeace) {
  Stage stage;
  stage.add_box({-100, -1, -100}, {100, 0, 100});
  for (int i = 0; i < 9; ++i) stage.add_light({i * 8 - 32, 2, 0}, 40.0f + 2.0f * static_cast<float>(i));
  stage.add_light({0, 30, 0}, 30000);  // 33 lx on the ground, where the lamps give 12
  expect_peace(stage);
}

TEST(LightAudit, NamesLightsBrighterThanTheSun) {
  Stage stage;
  stage.add_room();
  for (const float x : {-3.0f, 0.0f, 3.0f}) stage.add_light({x, 3, 0}, 683 * 100 * watt_cd + x);
  expect_one(stage, "brighter than direct sunlight");
}

TEST(LightAudit, NamesALightInAClosedBulb) {
  for (const bool double_sided : {false, true}) {
    Stage stage;
    stage.add_room();
    stage.add_box({-0.05f, 2.95f, -0.05f}, {0.05f, 3.05f, 0.05f}, {.double_sided = double_sided});
    stage.add_light({0, 3, 0});
    stage.add_light({3, 3, 0});
    expect_one(stage, "inside closed geometry, whose shadow blocks their light (lamp 0)");
  }
}

TEST(LightAudit, LeavesALightInABulbThatThrowsNoShadowInPeace) {
  for (const bool by_material : {false, true}) {
    Stage stage;
    stage.add_room();
    stage.add_box({-0.05f, 2.95f, -0.05f}, {0.05f, 3.05f, 0.05f});
    stage.add_light({0, 3, 0});
    stage.add_light({3, 3, 0});
    if (by_material) {
      stage.pack.materials.push_back({.shadowless = 1});
      stage.pack.batches.back().material = static_cast<uint32_t>(stage.pack.materials.size() - 1);
    } else {
      stage.pack.instances.back().shadowless = 1;
    }
    expect_peace(stage);
  }
}

TEST(LightAudit, NamesALightInAWallPlacedByAMirror) {
  for (const float mirror : {1.0f, -1.0f}) {
    Stage stage;
    stage.add_room();
    stage.add_box({2, 0, 2}, {4, 4, 4}, {.mirror = {mirror, 1, 1}});
    stage.add_light({3, 2, 3});
    expect_one(stage, "inside closed geometry");
  }
}

// A bulb of 5 mm keeps its light in; of a much smaller one nobody knows.
TEST(LightAudit, NamesLightsInTheTiniestOfBulbs) {
  for (const auto& [half_m, words] : {std::pair{0.005f, "inside closed geometry"}, {0.00005f, "mm of a surface"}}) {
    Stage stage;
    stage.add_room();
    stage.add_box(glm::vec3(0, 3, 0) - half_m, glm::vec3(0, 3, 0) + half_m);
    stage.add_light({0, 3, 0});
    expect_one(stage, words);
  }
}

TEST(LightAudit, LeavesLightsThatOnlySeemInsideInPeace) {
  const std::vector<std::function<void(Stage&)>> surroundings = {
      // A building: a closed shell outside, rooms within.
      [](Stage& stage) {
        stage.add_box({-6, -1, -6}, {6, 5, 6});
        stage.add_room();
      },
      // A shade that is open at the top, and one that nobody calls closed.
      [](Stage& stage) {
        stage.add_box({-0.2f, 2.8f, -0.2f}, {0.2f, 3.2f, 0.2f}, {.closed = false, .open_top = true});
      },
      [](Stage& stage) {
        stage.add_box({-0.2f, 2.8f, -0.2f}, {0.2f, 3.2f, 0.2f}, {.closed = false});
      },
      // A room made of one box whose walls are seen from within.
      [](Stage& stage) {
        stage.add_box({-5, 0, -5}, {5, 4, 5}, {.double_sided = true});
      },
      // Leaves: what their texture leaves open is not known.
      [](Stage& stage) {
        stage.add_box({-1, 2, -1}, {1, 4, 1}, {.masked = true});
      },
      // Beside a closed box.
      [](Stage& stage) {
        stage.add_box({0.5f, 0, 0.5f}, {1, 4, 1});
      },
  };
  for (size_t i = 0; i < surroundings.size(); ++i) {
    SCOPED_TRACE(i);
    Stage stage;
    stage.add_room();
    surroundings[i](stage);
    stage.add_light({0.001f, 3, 0.002f});
    expect_peace(stage);
  }
}

TEST(LightAudit, SaysNothingOfPlacesOfLightsThatMove) {
  Stage stage;
  stage.add_box({-1, -1, -1}, {1, 1, 1});
  stage.add_light({0, 0, 0}).dynamic = true;
  stage.add_light({1000, 0, 0}).dynamic = true;
  stage.scene.lights[1].range_m = 1;
  expect_peace(stage);
}

TEST(LightAudit, NamesLightsWhoseGroupIsNotAllThatTheirAuthorSaid) {
  Stage stage;
  stage.add_room();
  for (const float x : {-2.0f, 0.0f, 2.0f}) stage.add_light({x, 3, 0}, 40 + x).group = "row";
  expect_peace(stage);
  stage.scene.lights[1].unclustered = true;
  expect_one(stage, "in a group although cluster is false: they share the group's shadow map (lamp 1)");
  stage.scene.lights[1].unclustered = false;
  stage.scene.lights[2].type = LightType::directional;
  expect_one(stage, "directional in a group with lights of another type: they share no map with those (lamp 2)");
  stage.scene.lights[2].group = "suns";
  expect_peace(stage);
}

TEST(LightAudit, NamesLightsThatReachNothing) {
  Stage stage;
  stage.add_box({-1, -1, -1}, {1, 0, 1});
  stage.add_light({0, 3, 0}).range_m = 3.01f;
  stage.add_light({0, 3, 0}).range_m = 2.99f;
  stage.add_light({3, 1, 3}).range_m = 2.5f;  // the box's corner is farther: sqrt(1 + 4 + 4)
  for (const float up : {-1.0f, 1.0f}) {
    Light& spot = stage.add_light({0, 3, 0});
    spot.type = LightType::spot;
    spot.direction_ws = {0, up, 0};
    spot.outer_cone_rad = 0.1f;
  }
  expect_one(stage, "reaching nothing: no triangle is within their range and cone (lamp 1, lamp 2, lamp 4)");
}

TEST(LightAudit, CountsWhatMovesAmongWhatIsReached) {
  Stage stage;
  stage.add_box({-1, -1, -1}, {1, 0, 1});
  stage.add_box({9, 0, 9}, {10, 1, 10});
  stage.add_light({9, 2, 9}).range_m = 2;
  stage.pack.instances[1].dynamic = 1;
  expect_peace(stage);
}

/// The rule for triangles, against points strewn over many.
TEST(LightRays, AgreeWithPointsStrewnOverTrianglesInAndOutOfReach) {
  std::mt19937 random(17);
  std::uniform_real_distribution<float> place(-1, 1), one(0, 1);
  int reached = 0, missed = 0;
  for (int i = 0; i < 3000; ++i) {
    Stage stage;
    for (int corner = 0; corner < 3; ++corner) {
      stage.pack.positions.push_back({{place(random), place(random), place(random)}});
      stage.pack.indices.push_back({static_cast<uint32_t>(corner)});
    }
    stage.pack.batches.push_back({.index_count = 3});
    pack::Instance unmoved;
    for (int axis = 0; axis < 3; ++axis) unmoved.world_from_local[axis][axis] = 1;
    stage.pack.instances.push_back(unmoved);
    stage.pack.batch_instances.push_back({{-1, -1, -1}, 0, {1, 1, 1}, 0});
    Light& light = stage.add_light({place(random), place(random), place(random)});
    light.type = i % 2 ? LightType::spot : LightType::point;
    light.direction_ws = glm::normalize(glm::vec3(place(random), place(random), place(random)));
    light.outer_cone_rad = 0.05f + 1.4f * one(random);
    light.range_m = 0.1f + one(random);
    Strings strings(stage.pack.strings);
    make_lights(stage.scene, 0.05f, strings, stage.pack);
    const pack::Light& baked = stage.pack.lights[0];
    bool near = false, ahead = false, both = false;
    for (int k = 0; k < 2000; ++k) {
      const float u = one(random), v = one(random) * (1 - u);
      const glm::vec3 to = stage.pack.positions[0].position_ls * (1 - u - v) + stage.pack.positions[1].position_ls * u +
                           stage.pack.positions[2].position_ls * v - baked.position_ws;
      const bool is_near = glm::length(to) <= baked.range_m;
      const bool is_ahead = i % 2 == 0 || glm::dot(glm::normalize(to), baked.direction_ws) >= baked.outer_cone_cos;
      near |= is_near;
      ahead |= is_ahead;
      both |= is_near && is_ahead;
    }
    const bool answer = reaches_anything(stage.pack, baked);
    EXPECT_TRUE(answer || !both) << i;     // "no" is certain
    missed += answer && !(near && ahead);  // "yes" needs range and cone: only gaps between the points make it miss
    reached += answer;
  }
  EXPECT_GT(reached, 300);
  EXPECT_LT(missed, 30);
}

}  // namespace
}  // namespace chandelier::baker::test
