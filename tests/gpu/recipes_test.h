// SPDX-License-Identifier: Apache-2.0
// A room, and frames of it with one recipe or another.
#pragma once

#include <algorithm>
#include <cstdint>
#include <random>

#include "gpu_test.h"

namespace chandelier::test {

inline constexpr float pi = 3.14159265f;

// A room with a few boxes, a ball and a cut-out sheet, and `lights` lights of all three types in it.
inline Scene small_room(uint32_t lights) {
  Scene scene;
  const uint32_t grey = scene.add_material(plain_material(glm::vec3(0.5f), 0.0f, 0.5f));
  const uint32_t red = scene.add_material(plain_material({0.7f, 0.2f, 0.1f}, 0.4f, 0.3f));
  pack::Material cut = plain_material(glm::vec3(0.8f));
  cut.base_color_texture = scene.add_texture(2, 2, {0xFFFFFFFFu, 0x00FFFFFFu, 0x00FFFFFFu, 0xFFFFFFFFu});
  cut.alpha_mode = pack::AlphaMode::mask;
  cut.double_sided = 1;
  const uint32_t masked = scene.add_material(cut);
  scene.add(level_square({0, 0, 0}, 4.0f), grey);
  scene.add(quad({0, 2, -3}, {4, 0, 0}, {0, 2, 0}), red);
  for (int i = 0; i < 6; ++i) {
    const float x = -2.5f + static_cast<float>(i), z = i % 2 ? -1.0f : 0.6f;
    scene.add(box({x - 0.2f, 0.0f, z - 0.2f}, {x + 0.2f, 0.5f + 0.2f * static_cast<float>(i), z + 0.2f}),
              i % 2 ? red : grey);
  }
  scene.add(sphere({0.3f, 1.2f, -0.3f}, 0.4f, 24), grey);
  scene.add(quad({-1.2f, 1.4f, -0.4f}, {0.5f, 0, 0.1f}, {0, 0.4f, 0}), masked);
  std::mt19937 random(7);
  const auto uniform = [&](float from, float to) {
    return from + (to - from) * static_cast<float>(random() >> 8) * 0x1p-24f;
  };
  for (uint32_t i = 0; i < lights; ++i) {
    const glm::vec3 at(uniform(-3, 3), uniform(0.7f, 2.8f), uniform(-2.5f, 2.5f));
    const float candela = 20.0f / static_cast<float>(lights), range = uniform(2, 6);
    scene.lights.push_back(i % 3 == 1 ? spot_light(at, {uniform(-1, 1), -1, uniform(-1, 1)}, candela, range, 0.3f, 0.8f)
                                      : point_light(at, candela, range));
    scene.lights.back().color = {uniform(0.3f, 1), uniform(0.3f, 1), uniform(0.3f, 1)};
  }
  scene.lights.push_back(directional_light({0.3f, -1, -0.4f}, 0.5f));
  return scene;
}

inline RenderSettings room_settings(const Recipe& recipe) {
  RenderSettings settings = settings_for(look({1.5f, 2.2f, 4.5f}, {0, 0.8f, 0}, 0.9f), 128, 96, recipe);
  // For filter rays: everything is lit.
  settings.visibility = [](const VisibilityQuery& query) { std::ranges::fill(query.visibility, uint8_t{255}); };
  return settings;
}

inline Recipe recipe_with(Select select, Filter filter, float d_init_m) {
  Recipe recipe;
  recipe.select = select;
  recipe.filter = filter;
  recipe.d_init_m = d_init_m;
  recipe.face_size_px = 128;
  return recipe;
}

struct Frame {
  Picture picture;
  FrameStats stats;
};

class RecipesTest : public GpuTest {
 protected:
  Frame frame(Renderer& renderer, const RenderSettings& settings) {
    const FrameStats stats = renderer.draw(settings);
    return {renderer.read_back(), stats};
  }
  static void expect_same(const Frame& a, const Frame& b) {
    EXPECT_TRUE(a.picture.radiance == b.picture.radiance);
    EXPECT_TRUE(a.picture.shown == b.picture.shown);
  }
  static double brightness(const Picture& picture) {
    double sum = 0.0;
    for (size_t i = 0; i < picture.radiance.size(); ++i) sum += i % 4 == 3 ? 0.0 : double{picture.radiance[i]};
    return sum / static_cast<double>(picture.radiance.size() / 4);
  }
};

}  // namespace chandelier::test
