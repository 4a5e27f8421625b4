// SPDX-License-Identifier: Apache-2.0
// Wide penumbrae are smooth, and what pixels of a block share to make them so does not reach over edges of objects.
#include <algorithm>
#include <cmath>
#include <functional>
#include <iostream>

#include "gpu_test.h"

namespace chandelier::test {
namespace {

constexpr uint32_t size_px = 128;

pack::Light with_radius(pack::Light light, float radius_m) {
  light.radius_m = radius_m;
  return light;
}

// Of the floor, below half a plane to the left of x = 0 and `height_m` up, seen from below it.
struct FloorView {
  pack::Light light;
  float height_m;
  float eye_m;
};

class PenumbraTest : public GpuTest {
 protected:
  static Recipe soft(Filter filter, Deliver deliver) {
    Recipe recipe;
    recipe.filter = filter;
    recipe.deliver = deliver;
    recipe.shade = Shade::lambert;
    recipe.face_size_px = 1024;
    return recipe;
  }

  // How much of what it sees without the half plane each pixel of the picture sees.
  std::vector<float> visible(Scene scene, const FloorView& view, const Camera& camera, const Recipe& recipe) {
    const uint32_t grey = scene.add_material(plain_material(glm::vec3(0.5f)));
    scene.lights = {view.light};
    scene.add(level_square({0, 0, 0}, 8.0f), grey);
    const RenderSettings settings = settings_for(camera, size_px, size_px, recipe);
    const Picture bare = draw(device(), scene, settings);
    scene.add(quad({-4, view.height_m, 0}, {4, 0, 0}, {0, 0, -8}), grey);
    const Picture picture = draw(device(), scene, settings);
    std::vector<float> part;
    for (uint32_t i = 0; i < size_px * size_px; ++i)
      part.push_back(bare.radiance[4 * i] > 0.0f ? picture.radiance[4 * i] / bare.radiance[4 * i] : 0.0f);
    return part;
  }

  // All rows of the picture show the same: what differs between them is stipple.
  void expect_smooth(const FloorView& view, const Recipe& recipe) {
    const std::vector<float> part = visible({}, view, look({0, view.eye_m, 0}, glm::vec3(0.0f), 1.2f), recipe);
    float stipple = 0.0f, steepest = 0.0f;
    uint32_t within = 0;
    for (uint32_t x = 0; x + 1 < size_px; ++x) {
      float mean = 0.0f;
      for (uint32_t y = 0; y < size_px; ++y) mean += part[y * size_px + x] / size_px;
      within += mean > 0.02f && mean < 0.98f;
      for (uint32_t y = 0; y < size_px; ++y) {
        stipple = std::max(stipple, std::abs(part[y * size_px + x] - mean));
        steepest = std::max(steepest, std::abs(part[y * size_px + x + 1] - part[y * size_px + x]));
      }
    }
    std::cout << "penumbra " << within << " pixels wide, rows differ by up to " << stipple
              << ", neighbours in them by up to " << steepest << "\n";
    EXPECT_GT(within, 20u);
    EXPECT_LT(stipple, 0.03f);
    // A disc light's edge changes at most by 2 / pi of its radius' width: 1.27 of the penumbra's.
    EXPECT_LT(steepest, 0.05f + 1.3f / static_cast<float>(within));
  }
};

TEST_F(PenumbraTest, OfALampIsSmooth) {
  for (const Deliver deliver : {Deliver::inlined, Deliver::textures})
    expect_smooth({with_radius(point_light({0, 4, 0}, 30, 20), 0.4f), 2.0f, 1.2f}, soft(Filter::pcss, deliver));
}

TEST_F(PenumbraTest, OfASunIsSmooth) {
  expect_smooth({with_radius(directional_light({0, -1, 0}, 3), 0.03f), 8.0f, 1.2f},
                soft(Filter::pcss, Deliver::inlined));
}

TEST_F(PenumbraTest, ReadByPcfIsSmooth) {
  expect_smooth({with_radius(point_light({0, 4, 0}, 30, 20), 1.2f), 2.0f, 1.2f}, soft(Filter::pcf, Deliver::inlined));
}

// A board lies on the floor, across the penumbra, and beside it its own shadow, right where it touches. The board sees
// of the lamp what it sees everywhere along the half plane's edge, next to that shadow too.
TEST_F(PenumbraTest, DoesNotBleedOverTheEdgesOfObjects) {
  const FloorView view{with_radius(point_light({0, 4, -4}, 60, 20), 0.4f), 2.0f, 1.2f};
  constexpr float top_m = 0.05f, half_m = 0.2875f;
  Scene scene;
  scene.add(box({-4, 0, -half_m}, {4, top_m, half_m}), scene.add_material(plain_material(glm::vec3(0.5f))));
  const Recipe recipe = soft(Filter::pcss, Deliver::inlined);
  const RenderSettings settings =
      settings_for(look({0, view.eye_m, 0}, glm::vec3(0.0f), 1.2f), size_px, size_px, recipe);
  const std::vector<float> part = visible(scene, view, settings.camera, recipe);
  float worst = 0.0f;
  uint32_t on_board = 0, beside_shadow = 0;
  for (uint32_t y = 0; y + 2 < size_px; ++y) {
    for (uint32_t x = 0; x < size_px; ++x) {
      const auto on_top = [&](uint32_t row) {
        return std::abs(floor_point(settings, x, row).z) * (view.eye_m - top_m) / view.eye_m < half_m;
      };
      if (!on_top(y)) continue;
      const float middle = part[size_px / 2 * size_px + x];
      worst = std::max(worst, std::abs(part[y * size_px + x] - middle));
      ++on_board;
      beside_shadow += y % 2 == 0 && !on_top(y + 1) && part[(y + 1) * size_px + x] < middle - 0.3f;
    }
  }
  std::cout << on_board << " pixels of the board, " << beside_shadow << " in a block with its shadow, differ by up to "
            << worst << "\n";
  EXPECT_GT(on_board, 5000u);
  EXPECT_GT(beside_shadow, 20u);
  EXPECT_LT(worst, 0.06f);
}

}  // namespace
}  // namespace chandelier::test
