// SPDX-License-Identifier: Apache-2.0
// A room is drawn alike wherever in the pack's world it stands: what is drawn and read is reckoned from the light and
// the eye.
#include <algorithm>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <iostream>

#include "gpu_test.h"
#include "truth/ray_traced.h"

namespace chandelier::test {
namespace {

constexpr uint32_t width = 160, height = 90, pixels = width * height;

// A room of 6 x 3 x 6 m with posts, lamps near its walls. All numbers are multiples of 1/32 m, which floats hold as far
// as 500 km out.
void add_room(Scene& scene, uint32_t material, const glm::vec3& at) {
  const auto add = [&](const Mesh& mesh) { scene.add(mesh, material, glm::translate(glm::mat4(1.0f), at)); };
  add(level_square({0, 0, 0}, 3.0f));
  add(quad({0, 3, 0}, {3, 0, 0}, {0, 0, 3}));
  add(quad({0, 1.5f, -3}, {3, 0, 0}, {0, 1.5f, 0}));
  add(quad({-3, 1.5f, 0}, {0, 0, -3}, {0, 1.5f, 0}));
  add(quad({3, 1.5f, 0}, {0, 0, 3}, {0, 1.5f, 0}));
  for (int i = 0; i < 6; ++i) {
    const glm::vec3 low(-2.5f + static_cast<float>(i) * 0.875f, 0, i % 2 ? -1.5f : -0.25f);
    add(box(low, low + glm::vec3(0.25f, 1.0f + 0.25f * static_cast<float>(i), 0.25f)));
  }
  for (const glm::vec3& lamp :
       {glm::vec3(-2.875f, 2, -1), glm::vec3(2.875f, 1.5f, -2), glm::vec3(0.125f, 2.875f, 0.5f)})
    scene.lights.push_back(point_light(at + lamp, 8, 12));
}

Scene room(const glm::vec3& at) {
  Scene scene;
  add_room(scene, scene.add_material(plain_material(glm::vec3(0.5f))), at);
  return scene;
}

RenderSettings view_of_room(const glm::vec3& at, const Recipe& recipe) {
  RenderSettings settings = settings_for(look({0.5f, 1.75f, 2.875f}, {0, 1.25f, -3}, 1.2f), width, height, recipe);
  settings.camera.eye_ws += at;
  return settings;
}

struct Answers {
  const char* name;
  Recipe recipe;
};
std::vector<Answers> recipes() {
  std::vector<Answers> all;
  for (const auto& [name, filter] : {std::pair{"hard", Filter::hard}, {"pcf", Filter::pcf}, {"pcss", Filter::pcss}})
    for (const Deliver deliver : {Deliver::inlined, Deliver::textures}) {
      Recipe recipe{.filter = filter, .deliver = deliver};
      recipe.select = filter == Filter::hard ? Select::per_light : Select::light_clusters;
      recipe.reference_share = 2.0f;
      recipe.face_size_px = 256;
      all.push_back({name, recipe});
    }
  return all;
}

uint32_t differing(const Picture& a, const Picture& b) {
  uint32_t count = 0;
  for (uint32_t i = 0; i < pixels; ++i) {
    const float x = a.radiance[4 * i], y = b.radiance[4 * i];
    count += std::abs(x - y) > 1e-3f * std::max(x, y);
  }
  return count;
}

uint32_t lit(const Picture& picture) {
  uint32_t count = 0;
  for (uint32_t i = 0; i < pixels; ++i) count += picture.radiance[4 * i] > 0.0f;
  return count;
}

class FarTest : public GpuTest {
 protected:
  Picture picture_of(const pack::File& pack, RenderSettings settings) {
    const World world(pack);
    if (settings.recipe.filter == Filter::rays) settings.visibility = truth::ray_traced_visibility(world);
    Renderer renderer(device(), world);
    renderer.draw(settings);
    return renderer.read_back();
  }

  // Pixels of a room whose hard shadows are not those of rays.
  uint32_t wrong(const pack::File& pack, const glm::vec3& at) {
    Recipe maps{.shade = Shade::lambert, .face_size_px = 512}, rays = presets().back().recipe;
    rays.shade = Shade::lambert;
    return differing(picture_of(pack, view_of_room(at, maps)), picture_of(pack, view_of_room(at, rays)));
  }
};

TEST_F(FarTest, ARoomLooksTheSameWhereverItStands) {
  const glm::vec3 places[]{{1000, 0, 0}, {-10000, 0, 10000}, {500000, -2000, 500000}};
  for (const Answers& each : recipes()) {
    const Picture near = picture_of(room({0, 0, 0}).open(), view_of_room({0, 0, 0}, each.recipe));
    ASSERT_GT(lit(near), pixels * 9 / 10);
    for (const glm::vec3& at : places) {
      const Picture far = picture_of(room(at).open(), view_of_room(at, each.recipe));
      EXPECT_LE(differing(near, far), pixels / 1000) << each.name << " at " << at.x << " " << at.z;
    }
  }
}

TEST_F(FarTest, TheSunShinesTheSameWherever) {
  const glm::vec3 at(500000, -2000, 500000);
  const Recipe recipe{.face_size_px = 512};
  const auto sunny = [](const glm::vec3& place) {
    Scene scene;
    const uint32_t material = scene.add_material(plain_material(glm::vec3(0.5f)));
    add_room(scene, material, place);
    scene.lights = {directional_light({0.3f, -0.5f, -1}, 3)};
    return scene.open();
  };
  const Picture near = picture_of(sunny({0, 0, 0}), view_of_room({0, 0, 0}, recipe));
  const Picture far = picture_of(sunny(at), view_of_room(at, recipe));
  EXPECT_GT(lit(near), pixels / 4);
  EXPECT_LT(lit(near), pixels * 9 / 10);
  // Cascades are snapped to texels of the world, whose grid begins elsewhere.
  EXPECT_LE(differing(near, far), pixels / 50);
}

// A street of 20 km with a room at either end: both are as near to rays as the room alone.
TEST_F(FarTest, BothEndsOfAStreetAreRight) {
  const glm::vec3 ends[]{{0, 0, 0}, {20000, 0, 0}};
  Scene street = room(ends[0]);
  add_room(street, 0, ends[1]);
  street.add(box({3.5f, -0.5f, -4}, {19996, -0.25f, 4}), 0);
  const pack::File pack = street.open();
  const uint32_t alone = wrong(room({0, 0, 0}).open(), {0, 0, 0});
  EXPECT_LT(alone, pixels / 50);
  for (const glm::vec3& end : ends) {
    const uint32_t found = wrong(pack, end);
    std::cout << "at " << end.x << " m: " << found << " of " << pixels << " pixels, alone " << alone << "\n";
    EXPECT_LE(found, alone + alone / 10 + 2);
  }
}

}  // namespace
}  // namespace chandelier::test
