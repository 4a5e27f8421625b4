// SPDX-License-Identifier: Apache-2.0
// Lamps that are millimetres from what shadows their light.
#include <algorithm>
#include <cmath>
#include <iostream>

#include "gpu_test.h"
#include "truth/ray_traced.h"

namespace chandelier::test {
namespace {

constexpr uint32_t width = 160, height = 120, pixels = width * height;

struct Answers {
  const char* name;
  Filter filter;
};
constexpr Answers all_filters[]{{"hard", Filter::hard}, {"pcf", Filter::pcf}, {"pcss", Filter::pcss}};

class CloseTest : public GpuTest {
 protected:
  Picture picture_of(const pack::File& pack, RenderSettings settings) {
    const World world(pack);
    if (settings.recipe.filter == Filter::rays) settings.visibility = truth::ray_traced_visibility(world);
    Renderer renderer(device(), world);
    renderer.draw(settings);
    return renderer.read_back();
  }
};

// Two storeys, a single plane between them, and a lamp so far below it that faces of a cube see it at a millionth of
// the walls' distance; what is above is dark.
TEST_F(CloseTest, ALampUnderACeilingLightsNothingAboveIt) {
  for (const float below_m : {0.02f, 0.006f, 0.001f, 0.0003f}) {
    Scene scene;
    const uint32_t material = scene.add_material(plain_material(glm::vec3(0.5f)));
    scene.add(level_square({0, 0, 0}, 3.0f), material);
    scene.add(quad({0, 2.5f, 0}, {3, 0, 0}, {0, 0, 3}), material);
    scene.add(quad({0, 5, 0}, {3, 0, 0}, {0, 0, 3}), material);
    scene.add(quad({0, 2.5f, -3}, {3, 0, 0}, {0, 2.5f, 0}), material);
    scene.lights = {point_light({0.4f, 2.5f - below_m, 0.2f}, 60, 30)};
    scene.lights[0].nearest_caster_m = below_m;
    const pack::File pack = scene.open();
    for (const Answers& each : all_filters) {
      const Recipe recipe{.filter = each.filter, .face_size_px = 512};
      const RenderSettings settings = settings_for(look({0, 2.5f, 7}, {0, 2.5f, 0}, 1.05f), width, height, recipe);
      const Picture picture = picture_of(pack, settings);
      uint32_t above = 0, below = 0;
      for (uint32_t y = 0; y < height; ++y)
        for (uint32_t x = 0; x < width; ++x) {
          const bool is_lit = radiance_at(picture, x, y).x > 0.0f;
          const bool is_above = y < height / 2 - 1;  // the eye is level with the ceiling
          (is_above ? above : below) += is_lit;
        }
      EXPECT_EQ(above, 0u) << each.name << ", " << below_m << " m";
      EXPECT_GT(below, pixels / 8) << each.name << ", " << below_m << " m";
    }
  }
}

// A room with a post and a lamp, its sides of 1 and `size_m` long.
Scene room(float size_m) {
  Scene scene;
  const uint32_t material = scene.add_material(plain_material(glm::vec3(0.5f)));
  const auto add = [&](Mesh mesh) {
    for (Vertex& vertex : mesh.vertices) vertex.position *= size_m;
    scene.add(mesh, material);
  };
  add(level_square({0, 0, 0}, 0.5f));
  add(quad({0, 0.5f, -0.5f}, {0.5f, 0, 0}, {0, 0.5f, 0}));
  add(quad({-0.5f, 0.5f, 0}, {0, 0, -0.5f}, {0, 0.5f, 0}));
  add(quad({0.5f, 0.5f, 0}, {0, 0, 0.5f}, {0, 0.5f, 0}));
  add(box({-0.1f, 0, -0.2f}, {0.05f, 0.6f, -0.1f}));
  add(box({-0.35f, 0.2f, 0}, {-0.2f, 0.25f, 0.2f}));
  scene.lights = {point_light(glm::vec3(0.2f, 0.7f, 0.15f) * size_m, 1, 10 * size_m)};
  scene.lights[0].nearest_caster_m = 0.26f * size_m;
  return scene;
}

// Which pixels are lit does not depend on how large the room is.
TEST_F(CloseTest, ARoomOfMillimetresHasTheShadowsOfALargeOne) {
  const auto lit_pixels = [&](float size_m, const Recipe& recipe) {
    RenderSettings settings = settings_for(look({0.1f, 0.6f, 1.2f}, {0, 0.45f, 0}, 0.9f), width, height, recipe);
    settings.camera.eye_ws *= size_m;
    settings.camera.znear_m = 0.05f * size_m;
    const Picture picture = picture_of(room(size_m).open(), settings);
    std::vector<bool> lit;
    for (uint32_t i = 0; i < pixels; ++i) lit.push_back(picture.radiance[4 * i] > 0.0f);
    return lit;
  };
  const auto differing = [](const std::vector<bool>& a, const std::vector<bool>& b) {
    uint32_t count = 0;
    for (uint32_t i = 0; i < pixels; ++i) count += a[i] != b[i];
    return count;
  };
  const Recipe maps{.face_size_px = 1024};
  const auto large = lit_pixels(6, maps);
  const auto dark = std::count(large.begin(), large.end(), false);
  ASSERT_GT(dark, pixels / 10);
  ASSERT_LT(dark, pixels / 2);
  for (const float size_m : {0.6f, 0.06f, 0.006f}) {
    EXPECT_LE(differing(large, lit_pixels(size_m, maps)), pixels / 1000) << size_m;
    EXPECT_LE(differing(large, lit_pixels(size_m, presets().back().recipe)), pixels / 100) << "by rays, " << size_m;
  }
}

}  // namespace
}  // namespace chandelier::test
