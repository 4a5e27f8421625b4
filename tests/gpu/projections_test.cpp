// SPDX-License-Identifier: Apache-2.0
// Shaders contain only the projections that a frame's shadow maps have. A lamp and a sun together give what each gives
// alone.
#include <algorithm>

#include "gpu_test.h"

namespace chandelier::test {
namespace {

constexpr uint32_t size_px = 64;

class ProjectionsTest : public GpuTest {};

// A floor on which a box casts two soft shadows.
Scene scene_with(const std::vector<pack::Light>& lights) {
  Scene scene;
  const uint32_t material = scene.add_material(plain_material(glm::vec3(0.5f)));
  scene.add(level_square({0, 0, 0}, 8.0f), material);
  scene.add(box({-0.3f, 0.4f, -0.3f}, {0.3f, 0.6f, 0.3f}), material);
  scene.lights = lights;
  return scene;
}

pack::Light with_radius(pack::Light light, float radius) {
  light.radius_m = radius;
  return light;
}

TEST_F(ProjectionsTest, LampAndSunTogetherGiveWhatEachGivesAlone) {
  const pack::Light lamp = with_radius(point_light({1.0f, 2.0f, 0.3f}, 10.0f, 12.0f), 0.2f);
  const pack::Light sun = with_radius(directional_light(glm::normalize(glm::vec3(0.6f, -1.0f, 0.2f)), 2.0f), 0.05f);
  for (const Filter filter : {Filter::hard, Filter::pcf, Filter::pcss})
    for (const Deliver deliver : {Deliver::inlined, Deliver::textures}) {
      Recipe recipe;
      recipe.filter = filter;
      recipe.deliver = deliver;
      recipe.face_size_px = 128;
      const RenderSettings settings = settings_for(look({0, 3, 2}, {0, 0, 0}, 1.0f), size_px, size_px, recipe);
      const Picture both = draw(device(), scene_with({lamp, sun}), settings);
      const Picture by_lamp = draw(device(), scene_with({lamp}), settings);
      const Picture by_sun = draw(device(), scene_with({sun}), settings);
      uint32_t shadowed[2]{};  // pixels, of lamp and sun
      for (uint32_t y = 0; y < size_px; ++y)
        for (uint32_t x = 0; x < size_px; ++x) {
          const float a = radiance_at(by_lamp, x, y).x, b = radiance_at(by_sun, x, y).x;
          ASSERT_NEAR(radiance_at(both, x, y).x, a + b, 1e-5f * (a + b)) << x << ", " << y;
          shadowed[0] += a == 0.0f;
          shadowed[1] += b == 0.0f;
        }
      EXPECT_GT(shadowed[0], 20u);
      EXPECT_GT(shadowed[1], 20u);
    }
}

}  // namespace
}  // namespace chandelier::test
