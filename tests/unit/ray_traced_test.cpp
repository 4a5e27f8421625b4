// SPDX-License-Identifier: Apache-2.0
// Visibility by rays against shadows worked out by hand, in doubles.
#include "truth/ray_traced.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <optional>

#include "../gpu/scene_builder.h"
#include "pack_file.h"

namespace chandelier::truth {
namespace {

using namespace test;

constexpr float near_m = 0.01f;

frame::FrameLight frame_light(const glm::vec3& position_ws, float range_m) {
  return {.position_ws = position_ws,
          .range_m = range_m,
          .direction_ws = {0, -1, 0},
          .type = static_cast<uint32_t>(pack::LightType::point),
          .radiant = glm::vec3(1.0f),
          .cone_offset = 1.0f};
}
frame::FrameLight sun(const glm::vec3& direction) {
  return {.direction_ws = glm::normalize(direction),
          .type = static_cast<uint32_t>(pack::LightType::directional),
          .radiant = glm::vec3(1.0f),
          .cone_offset = 1.0f};
}

std::vector<uint8_t> ask(const pack::File& pack, const frame::FrameLight& light,
                         const std::vector<SurfacePoint>& points, float radius_m = 0.0f) {
  std::vector<uint8_t> visibility(points.size(), 99);
  const World world(pack);
  ray_traced_visibility(world)({light, near_m, radius_m, glm::vec3(0.0f), points, visibility});
  return visibility;
}
uint8_t ask(const pack::File& pack, const frame::FrameLight& light, const SurfacePoint& point) {
  return ask(pack, light, std::vector{point}).front();
}

// Points of the level plane at height 0, evenly over a square; more of them than one thread takes at a time.
std::vector<SurfacePoint> floor_points(float half_m) {
  std::vector<SurfacePoint> points;
  for (int z = 0; z < 131; ++z)
    for (int x = 0; x < 131; ++x)
      points.push_back(
          {{half_m * (static_cast<float>(x) / 65.0f - 1.0f), 0.0f, half_m * (static_cast<float>(z) / 65.0f - 1.0f)},
           {0, 1, 0}});
  return points;
}

// Does from + t · way, t of 0 to `end`, meet the box? By slabs.
bool meets_box(const glm::dvec3& from, const glm::dvec3& way, double end, const glm::dvec3& min,
               const glm::dvec3& max) {
  double first = 0.0, last = end;
  for (int axis = 0; axis < 3; ++axis) {
    const double a = (min[axis] - from[axis]) / way[axis], b = (max[axis] - from[axis]) / way[axis];
    first = std::max(first, std::min(a, b));
    last = std::min(last, std::max(a, b));
  }
  return first <= last;
}

constexpr glm::dvec3 box_min(-0.6, 0.8, -0.4), box_max(0.5, 1.3, 0.7);

// Nothing within a millimetre of the shadow's edge.
std::optional<bool> in_shadow_of_box(const SurfacePoint& point, const glm::dvec3& way, double end) {
  const glm::dvec3 from(point.position), slack(1e-3);
  const bool surely = meets_box(from, way, end, box_min + slack, box_max - slack);
  const bool perhaps = meets_box(from, way, end, box_min - slack, box_max + slack);
  return surely == perhaps ? std::optional(surely) : std::nullopt;
}

pack::File box_over_floor() {
  Scene scene;
  const uint32_t material = scene.add_material(plain_material(glm::vec3(0.5f)));
  scene.add(level_square({0, 0, 0}, 4.0f), material);
  scene.add(box(glm::vec3(box_min), glm::vec3(box_max)), material);
  return scene.open();
}

template <typename Way>
void expect_box_shadow(const frame::FrameLight& light, double end, Way way_from) {
  const std::vector<SurfacePoint> points = floor_points(3.0f);
  const std::vector<uint8_t> found = ask(box_over_floor(), light, points);
  int lit = 0, dark = 0, edge = 0;
  for (size_t i = 0; i < points.size(); ++i) {
    const auto expected = in_shadow_of_box(points[i], way_from(glm::dvec3(points[i].position)), end);
    ++(!expected ? edge : *expected ? dark : lit);
    if (!expected) continue;
    EXPECT_EQ(found[i], *expected ? 0 : 255) << points[i].position.x << " " << points[i].position.z;
  }
  EXPECT_GT(lit, 5000);
  EXPECT_GT(dark, 500);
  EXPECT_LT(edge, 200);
}

TEST(RayTraced, BoxShadowsAFloorFromAPointLight) {
  const glm::vec3 light(0.3f, 3.5f, -0.2f);
  expect_box_shadow(frame_light(light, 20.0f), 1.0, [&](const glm::dvec3& p) { return glm::dvec3(light) - p; });
}

TEST(RayTraced, BoxShadowsAFloorFromTheSun) {
  const frame::FrameLight light = sun({0.5f, -1.0f, 0.3f});
  expect_box_shadow(light, 1e9, [&](const glm::dvec3&) { return -glm::dvec3(light.direction_ws); });
}

TEST(RayTraced, NoLightBeyondItsRangeOutsideItsConeOrFromBehind) {
  Scene scene;
  scene.add(level_square({0, 0, 0}, 4.0f), scene.add_material(plain_material(glm::vec3(0.5f))));
  const pack::File pack = scene.open();
  frame::FrameLight light = frame_light({0, 2, 0}, 2.5f);
  EXPECT_EQ(ask(pack, light, {{1.4f, 0, 0}, {0, 1, 0}}), 255);
  EXPECT_EQ(ask(pack, light, {{1.6f, 0, 0}, {0, 1, 0}}), 0) << "beyond its range";
  EXPECT_EQ(ask(pack, light, {{1.4f, 0, 0}, {0, -1, 0}}), 0) << "from behind";
  EXPECT_EQ(ask(pack, light, {{1.4f, 0, 0}, {0, 0, 0}}), 0) << "nothing is seen there";
  EXPECT_EQ(ask(pack, sun({0, -1, 0}), {{1.4f, 0, 0}, {0, 1, 0}}), 255);
  EXPECT_EQ(ask(pack, sun({0, 1, 0}), {{1.4f, 0, 0}, {0, 1, 0}}), 0) << "the sun from below";
  light.type = static_cast<uint32_t>(pack::LightType::spot);
  light.cone_scale = 1.0f / (std::cos(0.3f) - std::cos(0.5f));
  light.cone_offset = -std::cos(0.5f) * light.cone_scale;
  EXPECT_EQ(ask(pack, light, {{2.0f * std::tan(0.49f), 0, 0}, {0, 1, 0}}), 255);
  EXPECT_EQ(ask(pack, light, {{2.0f * std::tan(0.51f), 0, 0}, {0, 1, 0}}), 0) << "outside its cone";
}

TEST(RayTraced, BothSidesCastAndInstancesStandWhereTheyArePlaced) {
  for (const float side : {1.0f, -1.0f})
    for (const float mirror : {1.0f, -1.0f}) {
      Scene scene;
      const uint32_t material = scene.add_material(plain_material(glm::vec3(0.5f)));
      glm::mat4 place = glm::translate(glm::mat4(1.0f), {1, 1, 0});
      place = glm::rotate(place, 0.5f, glm::vec3(0, 1, 0));
      scene.add(quad({2, 0, 0}, {0.5f, 0, 0}, {0, 0, side * 0.1f}), material,
                glm::scale(place, glm::vec3(mirror, 1, 1)));
      const pack::File pack = scene.open();
      // The quad's middle, (±2, 0, 0), turned by half a radian about +Y and moved.
      const glm::vec3 middle(1 + mirror * 2 * std::cos(0.5f), 0, -mirror * 2 * std::sin(0.5f));
      const glm::vec3 along(std::cos(0.5f), 0, -std::sin(0.5f)), across(std::sin(0.5f), 0, std::cos(0.5f));
      const auto lit = [&](const glm::vec3& p) { return ask(pack, sun({0, -1, 0}), {p, {0, 1, 0}}); };
      EXPECT_EQ(lit(middle), 0);
      EXPECT_EQ(lit(middle + 0.49f * along), 0);
      EXPECT_EQ(lit(middle + 0.51f * along), 255);
      EXPECT_EQ(lit(middle - 0.09f * across), 0);
      EXPECT_EQ(lit(middle - 0.11f * across), 255);
    }
}

// A level square of 2 m, 1 m above the ground, with four texels: transparent ones at upper left and lower right.
pack::Material masked_material(uint32_t texture, float cutoff) {
  pack::Material material = plain_material(glm::vec3(1.0f));
  material.alpha_mode = pack::AlphaMode::mask;
  material.alpha_cutoff = cutoff;
  material.base_color_texture = texture;
  return material;
}

TEST(RayTraced, LightFallsThroughWhatAnAlphaTestCutsOut) {
  const uint32_t clear = 0x66FFFFFF, solid = 0xFFFFFFFF;                 // alpha 0.4 and 1
  const UvTransform swapped{glm::vec3(0, 1, 0), glm::vec3(1, 0, 0.5f)};  // u from v; v from u, half an image further
  for (const UvTransform& transform : {uv_identity, swapped}) {
    Scene scene;
    const uint32_t texture = scene.add_texture(2, 2, {clear, solid, solid, clear}, transform);
    scene.add(level_square({0, 1, 0}, 1.0f), scene.add_material(masked_material(texture, 0.5f)));
    const pack::File pack = scene.open();
    std::vector<SurfacePoint> points;
    for (int z = 0; z < 20; ++z)
      for (int x = 0; x < 20; ++x)
        points.push_back(
            {{(static_cast<float>(x) - 9.5f) / 10.0f, 0, (static_cast<float>(z) - 9.5f) / 10.0f}, {0, 1, 0}});
    const auto found = ask(pack, sun({0, -1, 0}), points);
    for (size_t i = 0; i < points.size(); ++i) {
      // uv is (0, 0) at -x, -z, v growing with z; clamped outside.
      const glm::vec2 uv = (glm::vec2(points[i].position.x, points[i].position.z) + 1.0f) / 2.0f;
      const glm::vec2 at = transform == uv_identity ? uv : glm::vec2(uv.y, uv.x + 0.5f);
      const bool cut_out = (at.x < 0.5f) == (at.y < 0.5f);
      EXPECT_EQ(found[i], cut_out ? 255 : 0) << uv.x << " " << uv.y;
    }
  }
}

TEST(RayTraced, FactorsOfAlphaCountAndOpaqueMaterialsHaveNoTest) {
  const SurfacePoint below{{0.3f, 0, 0.2f}, {0, 1, 0}};
  const auto lit_below = [&](const pack::Material& material, bool with_texture) {
    Scene scene;
    pack::Material used = material;
    if (with_texture) used.base_color_texture = scene.add_texture(1, 1, {0x99FFFFFF});  // alpha 0.6
    scene.add(level_square({0, 1, 0}, 1.0f), scene.add_material(used));
    return ask(scene.open(), sun({0, -1, 0}), below);
  };
  pack::Material material = masked_material(pack::none, 0.5f);
  EXPECT_EQ(lit_below(material, true), 0);
  material.base_color_factor.a = 0.8f;
  EXPECT_EQ(lit_below(material, true), 255) << "0.6 · 0.8 is below 0.5";
  EXPECT_EQ(lit_below(material, false), 0) << "0.8 alone is not";
  material.base_color_factor.a = 0.4f;
  EXPECT_EQ(lit_below(material, false), 255);
  material.alpha_mode = pack::AlphaMode::opaque;
  EXPECT_EQ(lit_below(material, true), 0);
}

// Behind the hole of a masked square something solid still casts.
TEST(RayTraced, ARayGoesOnBehindAHole) {
  Scene scene;
  const uint32_t texture = scene.add_texture(1, 1, {0x00FFFFFF});
  scene.add(level_square({0, 1, 0}, 1.0f), scene.add_material(masked_material(texture, 0.5f)));
  scene.add(level_square({0, 2, 0}, 0.2f), scene.add_material(plain_material(glm::vec3(0.5f))));
  const pack::File pack = scene.open();
  EXPECT_EQ(ask(pack, sun({0, -1, 0}), {{0.1f, 0, 0}, {0, 1, 0}}), 0);
  EXPECT_EQ(ask(pack, sun({0, -1, 0}), {{0.3f, 0, 0}, {0, 1, 0}}), 255);
}

// A light may touch its lamp: as in shadow maps, the first centimetre before it casts nothing.
TEST(RayTraced, TheFirstCentimetreBeforeALightCastsNothing) {
  Scene scene;
  const uint32_t material = scene.add_material(plain_material(glm::vec3(0.5f)));
  scene.add(level_square({0, 2.0f - 0.009f, 0}, 1.0f), material);
  EXPECT_EQ(ask(scene.open(), frame_light({0, 2, 0}, 9.0f), {{0, 0, 0}, {0, 1, 0}}), 255);
  scene.add(level_square({0, 2.0f - 0.011f, 0}, 1.0f), material);
  EXPECT_EQ(ask(scene.open(), frame_light({0, 2, 0}, 9.0f), {{0, 0, 0}, {0, 1, 0}}), 0);
}

TEST(RayTraced, AnEmptySceneIsLit) {
  EXPECT_EQ(ask(Scene().open(), frame_light({0, 2, 0}, 9.0f), {{0, 0, 0}, {0, 1, 0}}), 255);
  EXPECT_TRUE(ask(Scene().open(), sun({0, -1, 0}), std::vector<SurfacePoint>()).empty());
}

// What part of a disc is above a straight line `x` radii above its middle: a segment of a circle.
double seen_part(double x) {
  const double c = std::clamp(x, -1.0, 1.0);
  return 0.5 - (std::asin(c) + c * std::sqrt(1.0 - c * c)) / 3.14159265358979;
}

// Half a plane hangs half way between the floor and the light, and ends where x is 0: seen from the floor at x, its
// edge covers the light up to -x. Of a sun, whose disc is as large as it is far, twice as high above the plane.
void expect_penumbra(const frame::FrameLight& light, double radius_m, double height_m, double edge_per_x) {
  Scene scene;
  scene.add(quad({-50, static_cast<float>(height_m), 0}, {50, 0, 0}, {0, 0, -50}),
            scene.add_material(plain_material(glm::vec3(0.5f))));
  std::vector<SurfacePoint> points;
  for (int i = -300; i <= 300; ++i)
    points.push_back({{0.0015f * static_cast<float>(i), 0, 0.01f * static_cast<float>(i % 7)}, {0, 1, 0}});
  const std::vector<uint8_t> found = ask(scene.open(), light, points, static_cast<float>(radius_m));
  double worst = 0, sum = 0;
  for (size_t i = 0; i < points.size(); ++i) {
    const double off = found[i] / 255.0 - seen_part(-points[i].position.x * edge_per_x / radius_m);
    worst = std::max(worst, std::abs(off));
    sum += off;
  }
  EXPECT_LT(worst, 0.12);  // of 32 rays each, evenly over the disc
  EXPECT_NEAR(sum / static_cast<double>(points.size()), 0.0, 0.005);
}

TEST(RayTraced, PenumbraIsThatOfALightWithARadius) {
  expect_penumbra(frame_light({0, 4, 0}, 30), 0.2, 2.0, 1.0);
  expect_penumbra(frame_light({0, 4, 0}, 30), 0.1, 3.0, 1.0 / 3.0);
}

TEST(RayTraced, PenumbraOfASunIsThatOfItsDisc) {
  expect_penumbra(sun({0, -1, 0}), 0.05, 4.0, 0.25);
}

}  // namespace
}  // namespace chandelier::truth
