// SPDX-License-Identifier: Apache-2.0
// Groups of maps: every map is drawn once, in order, within the limits, and shadow views cover every direction.
#include "shadows/store/map_groups.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "shadows/project/shadow_views.h"
#include "world_of.h"

namespace chandelier {
namespace {

struct Planned {
  LightList list;
  std::vector<frame::ShadowView> views;
  std::vector<MapGroup> groups;
};

// Maps with these many views each.
Planned plan(const std::vector<uint32_t>& views_of_maps, uint32_t cubes, uint64_t max_views) {
  Planned planned;
  for (const uint32_t count : views_of_maps) {
    planned.list.maps.push_back(
        {.size_px = 1, .first_view = static_cast<uint32_t>(planned.views.size()), .view_count = count});
    for (uint32_t face = 0; face < count; ++face) planned.views.push_back({.layer = face});
  }
  planned.groups = plan_groups(planned.list, {.cubes = cubes, .views = max_views});
  return planned;
}

void expect_sound(const Planned& planned, uint32_t cubes, uint64_t max_views) {
  uint32_t map = 0, view = 0;
  for (const MapGroup& group : planned.groups) {
    EXPECT_EQ(group.first_map, map);
    EXPECT_EQ(group.first_view, view);
    EXPECT_GE(group.map_count, 1u);
    EXPECT_LE(group.map_count, cubes);
    EXPECT_TRUE(group.map_count == 1 || group.view_count <= max_views);
    EXPECT_EQ(group.cube_count, group.map_count);  // all are as large as the layers
    map += group.map_count;
    view += group.view_count;
  }
  EXPECT_EQ(map, planned.list.maps.size());
  EXPECT_EQ(view, planned.views.size());
}

TEST(MapGroupsTest, LightsWithoutShadowAreShadedInTheLast) {
  LightList list;
  list.shadowless.resize(3);
  auto groups = plan_groups(list, {.cubes = 1});
  ASSERT_EQ(groups.size(), 1u);
  EXPECT_EQ(groups[0].map_count, 0u);
  EXPECT_EQ(groups[0].light_count, 0u);
  EXPECT_EQ(groups[0].shadowless_count, 3u);
  for (uint32_t i = 0; i < 2; ++i) list.maps.push_back({.size_px = 1, .first_light = i, .light_count = 1});
  groups = plan_groups(list, {.cubes = 1});
  ASSERT_EQ(groups.size(), 2u);
  EXPECT_EQ(groups[0].shadowless_count, 0u);
  EXPECT_EQ(groups[1].first_light + groups[1].light_count, 2u);
  EXPECT_EQ(groups[1].shadowless_count, 3u);
}

// Visibility textures lie one after the other and never exceed the limit, unless one alone does.
TEST(MapGroupsTest, VisibilityTexturesStayWithinTheirLimit) {
  LightList list;
  for (const uint32_t rows : {3u, 5u, 0u, 9u, 20u, 1u, 1u})
    list.maps.push_back({.size_px = 1,
                         .first_light = static_cast<uint32_t>(list.maps.size()),
                         .light_count = 1,
                         .rect_width = 10,
                         .rect_height = rows});
  const auto groups = plan_groups(list, {.cubes = 100, .visibility_bytes = 100});
  ASSERT_EQ(groups.size(), 4u);
  EXPECT_EQ(groups[0].map_count, 3u);
  EXPECT_EQ(groups[0].visibility_bytes, 80u);
  EXPECT_EQ(list.maps[1].first_visibility, 30u);
  EXPECT_EQ(list.maps[2].first_visibility, 80u);
  EXPECT_EQ(groups[2].visibility_bytes, 200u);  // alone
  EXPECT_EQ(groups[3].first_light, 5u);
  EXPECT_EQ(groups[3].light_count, 2u);
  EXPECT_EQ(list.maps[6].first_visibility, 10u);
}

TEST(MapGroupsTest, NothingNeedsNoGroup) {
  EXPECT_TRUE(plan({}, 4, 100).groups.empty());
}

TEST(MapGroupsTest, OneGroupWhereAllFits) {
  const Planned planned = plan({6, 6, 3, 6}, 4, 21);
  EXPECT_EQ(planned.groups.size(), 1u);
  expect_sound(planned, 4, 21);
}

TEST(MapGroupsTest, OneCubeAtATime) {
  const Planned planned = plan({6, 2, 6}, 1, 100);
  EXPECT_EQ(planned.groups.size(), 3u);
  expect_sound(planned, 1, 100);
}

TEST(MapGroupsTest, ViewsLimitAGroupButNotASingleMap) {
  const Planned planned = plan({6, 2, 2, 6, 6}, 10, 4);
  EXPECT_EQ(planned.groups.size(), 4u);  // 6 | 2 2 | 6 | 6
  expect_sound(planned, 10, 4);
}

TEST(MapGroupsTest, AnyPlanIsSound) {
  std::mt19937 random(5);
  for (int i = 0; i < 300; ++i) {
    std::vector<uint32_t> views(random() % 50);
    for (uint32_t& count : views) count = 1 + static_cast<uint32_t>(random() % 6);
    const auto cubes = static_cast<uint32_t>(1 + random() % 12);
    const uint64_t max_views = 1 + random() % 40;
    expect_sound(plan(views, cubes, max_views), cubes, max_views);
  }
}

pack::Light lamp(pack::LightType type, const glm::vec3& direction, float outer_rad) {
  pack::Light light;
  light.type = type;
  light.position_ws = {0.5f, 1, -4};
  light.direction_ws = glm::normalize(direction);
  light.range_m = type == pack::LightType::directional ? 0.0f : 5.0f;
  light.intensity = 1;
  light.color = glm::vec3(1);
  light.inner_cone_cos = type == pack::LightType::spot ? std::cos(0.5f * outer_rad) : 1.0f;
  light.outer_cone_cos = type == pack::LightType::spot ? std::cos(outer_rad) : -1.0f;
  return light;
}

std::vector<frame::ShadowView> views_of(const pack::Light& light, LightList& list) {
  list = select_lights(test::world_of({&light, 1}), {}, {}, 1.0f);
  size_maps({.face_size_px = 256}, list);
  return project_lights(list, {}, 1.0f, {{-5, 0, -10}, {5, 3, 5}});
}

bool sees(const frame::ShadowView& view, const glm::vec3& p) {
  const auto& c = view.clip_from_center;
  const glm::vec4 clip = glm::mat4(c[0], c[1], c[2], c[3]) * glm::vec4(p - view.center_ws, 1.0f);
  return clip.w > 0.0f && std::abs(clip.x) <= clip.w * 1.0001f && std::abs(clip.y) <= clip.w * 1.0001f &&
         clip.z >= 0.0f && clip.z <= clip.w;
}

// Each direction from a point light is seen by the face that Vulkan's cube sampling reads, with s and t as it reads
// them.
TEST(ShadowViewsTest, CubeFacesFollowVulkansTable) {
  LightList list;
  const auto views = views_of(lamp(pack::LightType::point, {0, -1, 0}, 0), list);
  ASSERT_EQ(views.size(), 6u);
  const struct {
    glm::vec3 r;
    uint32_t face;
    glm::vec2 st;  // of the middle of the face towards the corner
  } table[]{{{2, 0.5f, -1}, 0, {1, -0.5f}}, {{-2, 0.5f, -1}, 1, {-1, -0.5f}}, {{0.5f, 2, -1}, 2, {0.5f, -1}},
            {{0.5f, -2, -1}, 3, {0.5f, 1}}, {{0.5f, -1, 2}, 4, {0.5f, 1}},    {{0.5f, -1, -2}, 5, {-0.5f, 1}}};
  for (const auto& row : table) {
    const frame::ShadowView& view = views[row.face];
    const auto& c = view.clip_from_center;
    const glm::vec4 clip = glm::mat4(c[0], c[1], c[2], c[3]) * glm::vec4(row.r, 1.0f);
    EXPECT_EQ(view.layer, row.face);
    EXPECT_NEAR(clip.x / clip.w, row.st.x / 2, 1e-6) << "face " << row.face;
    EXPECT_NEAR(clip.y / clip.w, row.st.y / 2, 1e-6) << "face " << row.face;
    EXPECT_NEAR(clip.z / clip.w, list.maps[0].near_m / 2, 1e-6);
  }
}

// What a cone lights is seen by one of the faces that were kept.
TEST(ShadowViewsTest, SpotLightsKeepEveryFaceTheirConeTouches) {
  std::mt19937 random(6);
  const auto uniform = [&](float from, float to) {
    return from + (to - from) * static_cast<float>(random() >> 8) * 0x1p-24f;
  };
  uint32_t spared = 0;
  for (int i = 0; i < 500; ++i) {
    const glm::vec3 direction(uniform(-1, 1), uniform(-1, 1), uniform(-1, 1) + 1e-3f);
    const pack::Light light = lamp(pack::LightType::spot, direction, uniform(0.05f, 1.5f));
    LightList list;
    const auto views = views_of(light, list);
    ASSERT_EQ(list.maps.size(), 1u);
    EXPECT_EQ(list.maps[0].view_count, views.size());
    spared += 6 - static_cast<uint32_t>(views.size());
    for (int k = 0; k < 200; ++k) {
      const glm::vec3 way = glm::normalize(glm::vec3(uniform(-1, 1), uniform(-1, 1), uniform(-1, 1) + 1e-4f));
      if (glm::dot(way, light.direction_ws) <= light.outer_cone_cos) continue;
      bool seen = false;
      for (const auto& view : views) seen = seen || sees(view, light.position_ws + 2.0f * way);
      EXPECT_TRUE(seen);
    }
  }
  EXPECT_GT(spared, 500u);
}

// Wherever a member of a cluster of spot lights reaches, beside or far from the centre, there is a face that sees it.
TEST(ShadowViewsTest, ClustersOfSpotLightsKeepEveryFaceThatAMemberReaches) {
  std::mt19937 random(8);
  const auto uniform = [&](float from, float to) {
    return from + (to - from) * static_cast<float>(random() >> 8) * 0x1p-24f;
  };
  const auto uniform3 = [&](float from, float to) {
    const float x = uniform(from, to), y = uniform(from, to);
    return glm::vec3(x, y, uniform(from, to));
  };
  uint32_t spared = 0, points = 0;
  for (int i = 0; i < 400; ++i) {
    const glm::vec3 direction = uniform3(-1, 1) + glm::vec3(0, 0, 1e-3f);
    std::vector<pack::Light> lights;
    for (int k = 0; k < 3; ++k) {
      lights.push_back(lamp(pack::LightType::spot, direction + uniform3(-0.2f, 0.2f), uniform(0.05f, 0.9f)));
      lights[k].position_ws += uniform3(-0.3f, 0.3f);
    }
    Recipe recipe{.select = Select::light_clusters, .filter = Filter::pcf, .d_init_m = 3.0f};
    recipe.area_radius = i % 2 == 0 ? AreaRadius::spread : AreaRadius::d_min;
    LightList list = select_lights(test::world_of(lights), recipe, {}, 1.0f);
    size_maps({.face_size_px = 256}, list);
    const auto views = project_lights(list, {}, 1.0f, {{-5, 0, -10}, {5, 3, 5}});
    ASSERT_EQ(list.maps.size(), 1u);
    spared += 6 - static_cast<uint32_t>(views.size());
    for (int k = 0; k < 300; ++k) {
      const pack::Light& light = lights[k % 3];
      const glm::vec3 way = glm::normalize(light.direction_ws + uniform3(-1, 1));
      const glm::vec3 p = light.position_ws + light.range_m * uniform(0.02f, 1.0f) * way;
      if (glm::dot(way, light.direction_ws) <= light.outer_cone_cos) continue;
      EXPECT_TRUE(std::any_of(views.begin(), views.end(), [&](const auto& view) { return sees(view, p); }));
      ++points;
    }
  }
  EXPECT_GT(spared, 40u);  // few: beside a member that is off the centre, its light comes from everywhere
  EXPECT_GT(points, 20000u);
}

// Six cascades, each beyond the one before; whatever the camera sees of the scene is inside the cascade of its depth.
TEST(ShadowViewsTest, CascadesCoverWhatIsInView) {
  LightList list;
  const auto views = views_of(lamp(pack::LightType::directional, {0.3f, -1, 0.2f}, 0), list);
  ASSERT_EQ(views.size(), frame::cascade_count);
  EXPECT_EQ(list.maps[0].projection, frame::Projection::cascade);
  std::mt19937 random(7);
  const Camera camera;  // at the origin, along -z
  const FrustumPlanes planes = frustum_planes(camera, 1.0f);
  uint32_t tested = 0;
  for (int i = 0; i < 5000; ++i) {
    const auto uniform = [&](float from, float to) {
      return from + (to - from) * static_cast<float>(random() >> 8) * 0x1p-24f;
    };
    const float x = uniform(-5, 5), y = uniform(0, 3);
    const glm::vec3 p(x, y, uniform(-10, 0));
    if (!intersects(planes, p, 0.0f)) continue;
    uint32_t cascade = 0;
    while (cascade + 1 < views.size() && -p.z > views[cascade].far_m) ++cascade;
    EXPECT_TRUE(sees(views[cascade], p));
    ++tested;
  }
  EXPECT_GT(tested, 500u);
  for (size_t i = 1; i < views.size(); ++i) EXPECT_GT(views[i].far_m, views[i - 1].far_m);
}

}  // namespace
}  // namespace chandelier
