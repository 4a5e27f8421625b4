// SPDX-License-Identifier: Apache-2.0
// Pictures whose visibility rays tell: against shadows worked out by hand, and against shadow maps.
#include <algorithm>
#include <glm/gtc/matrix_transform.hpp>
#include <iostream>
#include <random>

#include "gpu_test.h"
#include "truth/ray_traced.h"

namespace chandelier::test {
namespace {

constexpr uint32_t width = 160, height = 120;
constexpr uint32_t pixels = width * height;

Recipe recipe_of(std::string_view preset) {
  const auto all = presets();
  Recipe recipe = std::find_if(all.begin(), all.end(), [&](const Preset& p) { return p.name == preset; })->recipe;
  recipe.face_size_px = 1024;
  recipe.shade = Shade::lambert;
  return recipe;
}

// Does the way from `p` to `light` meet the box? By slabs, in doubles.
bool is_blocked(const glm::dvec3& p, const glm::dvec3& light, const glm::dvec3& min, const glm::dvec3& max) {
  double first = 0.0, last = 1.0;
  for (int axis = 0; axis < 3; ++axis) {
    const double a = (min[axis] - p[axis]) / (light[axis] - p[axis]);
    const double b = (max[axis] - p[axis]) / (light[axis] - p[axis]);
    first = std::max(first, std::min(a, b));
    last = std::min(last, std::max(a, b));
  }
  return first <= last;
}

// The points around one at which a shadow map of this many texels may look when it is asked about it: up to `texels`
// away across the light's way, in the point's own plane and above it by a texel. Empty where the plane is too steep.
std::vector<SurfacePoint> around(const SurfacePoint& point, const frame::FrameLight& light, float texel_m,
                                 float texels) {
  const bool is_sun = light.type == static_cast<uint32_t>(pack::LightType::directional);
  const glm::vec3 way = is_sun ? light.direction_ws : point.position - light.position_ws;
  const glm::vec3 a = glm::normalize(
      glm::cross(way, std::abs(way.y) < glm::length(way) * 0.9f ? glm::vec3(0, 1, 0) : glm::vec3(1, 0, 0)));
  const glm::vec3 b = glm::normalize(glm::cross(way, a));
  std::vector<SurfacePoint> points;
  for (int i = 0; i < 16; ++i) {
    const float reach = (i & 4 ? texels : 0.5f * texels) * texel_m;
    const glm::vec3 across = reach * ((i & 1 ? 1.0f : -1.0f) * a + (i & 2 ? 1.0f : -1.0f) * b);
    const glm::vec3 along = is_sun ? way : way + across;
    const float slide = -glm::dot(point.normal_ws, across) / glm::dot(point.normal_ws, along);
    if (!(std::abs(slide) < 0.5f)) return {};
    const float lift_m = i & 8 ? texel_m : 0.0f;
    points.push_back({point.position + across + slide * along + lift_m * point.normal_ws, point.normal_ws});
  }
  return points;
}

float texel_of(const pack::Light& light, const glm::vec3& p) {
  const glm::vec3 d = glm::abs(p - light.position_ws);
  // The cascade that reaches over the whole scene, which is 11 m from corner to corner.
  return (light.type == pack::LightType::directional ? 11.4f : 2.0f * std::max(d.x, std::max(d.y, d.z))) / 1024.0f;
}

struct Differences {
  uint32_t edges = 0;  // pixels that may differ
  uint32_t count = 0;  // that do
  uint32_t away_from_edges = 0;
};

class TruthPictureTest : public GpuTest {
 protected:
  Picture picture_of(const pack::File& pack, const Camera& camera, std::string_view preset) {
    world_.emplace(pack);
    RenderSettings settings = settings_for(camera, width, height, recipe_of(preset));
    if (settings.recipe.filter == Filter::rays)
      settings.visibility = [this, rays = truth::ray_traced_visibility(*world_)](const VisibilityQuery& query) {
        rays(query);
        asked_ = {query.light, query.near_m, {query.points.begin(), query.points.end()}, rays};
        for (SurfacePoint& point : asked_.points) point.position += query.eye_ws;
      };
    Renderer renderer(device(), *world_);
    renderer.draw(settings);
    return renderer.read_back();
  }

  // Do rays find both light and shadow within two texels of what a pixel shows?
  bool is_edge(uint32_t pixel, const pack::Light& light) const {
    const SurfacePoint& point = asked_.points[pixel];
    if (point.normal_ws == glm::vec3(0.0f)) return false;
    const auto near = around(point, asked_.light, texel_of(light, point.position), 2.0f);
    std::vector<uint8_t> visibility(near.size());
    asked_.rays({asked_.light, asked_.near_m, 0.0f, glm::vec3(0.0f), near, visibility});
    const auto lit = static_cast<size_t>(std::count(visibility.begin(), visibility.end(), 255));
    return near.empty() || (lit != 0 && lit != near.size());
  }

  // Pixels that differ by more than rounding.
  Differences differences(const Picture& truth, const Picture& maps, const pack::Light& light) {
    Differences found;
    for (uint32_t i = 0; i < pixels; ++i) {
      const float a = truth.radiance[4 * i], b = maps.radiance[4 * i];
      const bool differs = std::abs(a - b) > 1e-5f * std::max(a, b);
      const bool edge = is_edge(i, light);
      found.edges += edge;
      found.count += differs;
      found.away_from_edges += differs && !edge;
    }
    return found;
  }

  std::optional<World> world_;  // of the last picture
  // What rays were last asked about.
  struct Asked {
    frame::FrameLight light;
    float near_m;
    std::vector<SurfacePoint> points;  // in the world
    VisibilitySource rays;
  } asked_;
};

// The camera hangs below the box: every pixel is floor. Where the shadow's edge is more than a millimetre away, a pixel
// is black, or exactly what it is without the box.
TEST_F(TruthPictureTest, ShadowOfABoxLiesWhereGeometrySays) {
  const glm::dvec3 min(-0.5, 1.2, -0.4), max(0.3, 1.5, 0.2), light(0.2, 3.0, -0.3), slack(5e-4);
  Scene bare;
  const uint32_t material = bare.add_material(plain_material(glm::vec3(0.5f)));
  bare.add(level_square({0, 0, 0}, 8.0f), material);
  bare.lights = {point_light(glm::vec3(light), 40, 12)};
  Scene shadowed = bare;
  shadowed.add(box(glm::vec3(min), glm::vec3(max)), material);
  const Camera camera = look({0, 1.1f, 0}, {0, 0, 0}, 1.4f);
  const RenderSettings settings = settings_for(camera, width, height, {});
  const Picture without = picture_of(bare.open(), camera, "truth");
  const Picture with = picture_of(shadowed.open(), camera, "truth");
  uint32_t lit = 0, dark = 0;
  for (uint32_t y = 0; y < height; ++y) {
    for (uint32_t x = 0; x < width; ++x) {
      const glm::dvec3 p(floor_point(settings, x, y));
      ASSERT_GT(radiance_at(without, x, y).x, 0.0f);
      if (is_blocked(p, light, min + slack, max - slack)) {
        ++dark;
        EXPECT_EQ(radiance_at(with, x, y), glm::vec3(0.0f)) << x << " " << y;
      } else if (!is_blocked(p, light, min - slack, max + slack)) {
        ++lit;
        EXPECT_EQ(radiance_at(with, x, y), radiance_at(without, x, y)) << x << " " << y;
      }
    }
  }
  EXPECT_GT(lit, pixels / 3);
  EXPECT_GT(dark, pixels / 6);
  EXPECT_GT(lit + dark, pixels * 98 / 100);
}

// Boxes and balls on a floor, a sheet with holes, a wall behind.
Scene cluttered_floor(const pack::Light& light) {
  Scene scene;
  const uint32_t grey = scene.add_material(plain_material(glm::vec3(0.5f)));
  pack::Material cut = plain_material(glm::vec3(0.8f));
  cut.base_color_texture = scene.add_texture(2, 2, {0xFFFFFFFFu, 0x00FFFFFFu, 0x00FFFFFFu, 0xFFFFFFFFu});
  cut.alpha_mode = pack::AlphaMode::mask;
  const uint32_t masked = scene.add_material(cut);
  scene.add(level_square({0, 0, 0}, 4.0f), grey);
  scene.add(quad({0, 2, -3}, {4, 0, 0}, {0, 2, 0}), grey);
  std::mt19937 random(3);
  const auto uniform = [&](float from, float to) {
    return from + (to - from) * static_cast<float>(random() >> 8) * 0x1p-24f;
  };
  for (int i = 0; i < 24; ++i) {
    const float x = uniform(-3, 3), y = uniform(0, 1.2f), z = uniform(-2.5f, 2);
    glm::mat4 place = glm::translate(glm::mat4(1.0f), {x, y, z});
    place = glm::rotate(place, uniform(0, 6), glm::vec3(0.6f, 0.8f, 0.0f));
    if (i % 3 == 0)
      scene.add(sphere(glm::vec3(0.0f), 0.25f, 32), grey, place);
    else
      scene.add(box(glm::vec3(-0.2f, -0.15f, -0.3f), glm::vec3(0.2f, 0.15f, 0.3f)), grey, place);
  }
  scene.add(quad({0.5f, 1.6f, 0.3f}, {0.8f, 0, 0.1f}, {0, 0.1f, -0.5f}), masked);
  scene.lights = {light};
  return scene;
}

TEST_F(TruthPictureTest, HardShadowMapsDifferWithinTwoTexelsOfShadowEdges) {
  const std::pair<const char*, pack::Light> cases[]{
      {"point", point_light({0.8f, 2.6f, 0.9f}, 40, 12)},
      {"spot", spot_light({-1.0f, 2.8f, 1.2f}, {0.3f, -1, -0.4f}, 60, 12, 0.4f, 0.8f)},
      {"sun", directional_light({0.4f, -1, -0.3f}, 3)}};
  const Camera camera = look({1.2f, 2.4f, 4.0f}, {0, 0.3f, -0.3f}, 0.9f);
  for (const auto& [name, light] : cases) {
    const pack::File pack = cluttered_floor(light).open();
    const Picture truth = picture_of(pack, camera, "truth");
    const Picture maps = picture_of(pack, camera, "reference");
    ASSERT_EQ(asked_.points.size(), pixels) << "the light reaches the whole picture";
    const Differences found = differences(truth, maps, light);
    std::cout << name << ": " << found.count << " of " << pixels << " pixels differ, " << found.away_from_edges
              << " away from edges, " << found.edges << " are edges\n";
    EXPECT_LT(found.count, pixels / 100) << name;
    EXPECT_EQ(found.away_from_edges, 0u) << name;
    EXPECT_LT(found.edges, pixels / 8) << name << ": or the line above would say little";
    const auto lit = std::count_if(truth.radiance.begin(), truth.radiance.end(), [](float v) { return v != 0.0f; });
    EXPECT_GT(lit, 4 * pixels / 3) << name;  // alpha is 1
  }
}

}  // namespace
}  // namespace chandelier::test
