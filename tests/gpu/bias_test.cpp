// SPDX-License-Identifier: Apache-2.0
// Filters neither speckle nor detach: what is lit is lit exactly, shadows begin where things touch, and PCSS' penumbrae
// are as wide as those of a disc light.
#include <algorithm>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <iostream>

#include "../unit/world_of.h"
#include "gpu_test.h"
#include "lights/light_list.h"

namespace chandelier::test {
namespace {

constexpr float pi = 3.14159265f;
constexpr uint32_t size_px = 96;

const Scene& with_light(Scene& scene, const pack::Light& light) {
  scene.lights = {light};
  return scene;
}

// The lone light of a scene is a cluster of radius d_init: it is not drawn as the reference would be.
Recipe clustered(Filter filter, float d_init_m, uint32_t face_size_px) {
  Recipe recipe;
  recipe.select = Select::light_clusters;
  recipe.reference_share = 2.0f;
  recipe.distance_scaling = DistanceScaling::none;
  recipe.filter = filter;
  recipe.shade = Shade::lambert;
  recipe.d_init_m = d_init_m;
  recipe.face_size_px = face_size_px;
  return recipe;
}

Picture frame(Renderer& renderer, const RenderSettings& settings) {
  renderer.draw(settings);
  return renderer.read_back();
}

// Red of each column of a picture whose rows are all alike, relative to `expected`.
std::vector<float> columns(const Picture& picture, const Picture& expected) {
  std::vector<float> mean(picture.width);
  for (uint32_t x = 0; x < picture.width; ++x) {
    for (uint32_t y = 0; y < picture.height; ++y)
      mean[x] += radiance_at(picture, x, y).x / radiance_at(expected, x, y).x;
    mean[x] /= static_cast<float>(picture.height);
  }
  return mean;
}

class BiasTest : public GpuTest {
 protected:
  // A lone receiver that nothing can shadow has not one darker pixel, with any filter, radius and resolution.
  void expect_no_speckle(Scene scene, const pack::Light& light, const Camera& camera, const std::string& name) {
    const pack::File pack = with_light(scene, light).open();
    const World world(pack);
    Renderer renderer(device(), world);
    const RenderSettings bare = settings_for(camera, size_px, size_px, clustered(Filter::hard, 0.0f, 64));
    const Picture expected = frame(renderer, without_shadows(bare));
    uint32_t lit = 0;
    for (uint32_t i = 0; i < size_px * size_px; ++i) lit += expected.radiance[4 * i] > 0.0f;
    EXPECT_GT(lit, size_px * size_px / 20) << name;
    for (const uint32_t face_size_px : {64u, 512u}) {
      for (const auto& [filter, d_init_m] :
           {std::pair(Filter::hard, 0.0f), std::pair(Filter::pcf, 0.0f), std::pair(Filter::pcf, 4.0f),
            std::pair(Filter::pcss, 0.5f), std::pair(Filter::pcss, 3.0f), std::pair(Filter::pcss, 20.0f)}) {
        RenderSettings settings = bare;
        settings.recipe = clustered(filter, d_init_m, face_size_px);
        const Picture picture = frame(renderer, settings);
        uint32_t speckles = 0;
        for (uint32_t i = 0; i < size_px * size_px; ++i)
          speckles += picture.radiance[4 * i] < 0.9999f * expected.radiance[4 * i];
        EXPECT_EQ(speckles, 0u) << name << ", light at " << light.position_ws.x << " " << light.position_ws.y << " "
                                << light.position_ws.z << ", faces " << face_size_px << ", filter "
                                << static_cast<uint32_t>(filter) << ", d_init " << d_init_m;
      }
    }
  }
};

Scene lone(const Mesh& mesh, const glm::mat4& world_from_local = glm::mat4(1.0f)) {
  Scene scene;
  scene.add(mesh, scene.add_material(plain_material(glm::vec3(0.5f))), world_from_local);
  return scene;
}

// From nearly grazing to steep; edges and corners between cube faces lie on the floor below all but the first.
const glm::vec3 places[]{
    {0.3f, 0.04f, -0.2f}, {-0.4f, 0.3f, 0.1f}, {0.12f, 1.0f, -0.07f}, {-2.0f, 1.5f, 1.3f}, {1, 4, 2}};

TEST_F(BiasTest, LevelFloorHasNoSpeckle) {
  for (const glm::vec3& place : places)
    expect_no_speckle(lone(level_square(glm::vec3(0.0f), 8)), point_light(place, 30, 20),
                      look({0, 2.5f, 0}, glm::vec3(0.0f), 0.5f * pi), "floor");
}

TEST_F(BiasTest, TiltedPlaneHasNoSpeckle) {
  for (const glm::vec3& place : places) {
    const glm::mat4 tilted = glm::rotate(glm::mat4(1.0f), 0.6f, {0.8f, 0.3f, -0.5f});
    const glm::vec3 turned(tilted * glm::vec4(place, 0.0f));
    expect_no_speckle(lone(level_square(glm::vec3(0.0f), 8), tilted), point_light(turned, 30, 20),
                      look(glm::vec3(tilted * glm::vec4(0, 2.5f, 0, 0)), glm::vec3(0.0f), 0.5f * pi), "plane");
  }
}

TEST_F(BiasTest, BallHasNoSpeckle) {
  for (const glm::vec3& place : places)
    expect_no_speckle(lone(sphere({0, -1, 0}, 1.0f, 48)), point_light(place, 30, 20),
                      look({0.5f, 1.5f, 1}, {0, -0.7f, 0}, 1.0f), "ball");
}

TEST_F(BiasTest, SunHasNoSpeckle) {
  for (const glm::vec3& way : {glm::vec3(0.1f, -1, 0.05f), glm::vec3(1, -0.4f, 0.3f), glm::vec3(-0.6f, -0.06f, 1)}) {
    const pack::Light sun = directional_light(glm::normalize(way), 3);
    expect_no_speckle(lone(level_square(glm::vec3(0.0f), 8)), sun, look({0, 1, 6}, {0, 0, 2}, 1.0f), "floor");
    expect_no_speckle(lone(sphere({0, -1, 0}, 1.0f, 48)), sun, look({0.5f, 1.5f, 1}, {0, -0.7f, 0}, 1.0f), "ball");
  }
}

// A sheet leans on the floor along x = 0 and rises by one to the right. Below it is shadow, which begins within six
// texels of the contact: the plane is moved by 1.5 texels where it lies aslant, under which the sheet's lowest part
// vanishes, the disc is 1.5 wide, and bilinear taps read one farther.
void expect_shadow_from_the_contact(Renderer& renderer, const glm::vec3& lamp, const Recipe& recipe) {
  const RenderSettings settings = settings_for(look({2.0f, 0.15f, 0}, {0, 0, 0}, 0.4f), size_px, size_px, recipe);
  const Picture picture = frame(renderer, settings);
  uint32_t seen = 0, lit = 0;
  for (uint32_t y = 0; y < size_px; ++y) {
    for (uint32_t x = 0; x < size_px; ++x) {
      if (pixel_direction(settings, x, y).y >= -0.01f) continue;
      const glm::vec3 p = floor_point(settings, x, y), d = glm::abs(p - lamp);
      const float texel_m = 2.0f / static_cast<float>(recipe.face_size_px) * std::max({d.x, d.y, d.z});
      if (p.x < 6.0f * texel_m || p.x > 0.8f || std::abs(p.z) > 0.8f) continue;
      ++seen;
      lit += radiance_at(picture, x, y).x > 0.0f;
    }
  }
  EXPECT_GT(seen, 200u);
  EXPECT_EQ(lit, 0u) << "filter " << static_cast<uint32_t>(recipe.filter) << ", faces " << recipe.face_size_px
                     << ", lamp at height " << lamp.y;
}

TEST_F(BiasTest, ShadowBeginsAtTheContact) {
  for (const glm::vec3& lamp : {glm::vec3(0.3f, 4.0f, 0.2f), glm::vec3(-2.0f, 1.0f, 0.2f)}) {
    Scene scene = lone(level_square(glm::vec3(0.0f), 8));
    scene.add(quad({1, 1, 0}, {1, 1, 0}, {0, 0, -2}), 0);
    const pack::File pack = with_light(scene, point_light(lamp, 30, 20)).open();
    const World world(pack);
    Renderer renderer(device(), world);
    for (const uint32_t face_size_px : {128u, 512u}) {
      expect_shadow_from_the_contact(renderer, lamp, clustered(Filter::hard, 0.0f, face_size_px));
      expect_shadow_from_the_contact(renderer, lamp, clustered(Filter::pcf, 0.0f, face_size_px));
      expect_shadow_from_the_contact(renderer, lamp, clustered(Filter::pcss, 0.5f, face_size_px));
    }
  }
}

// What part of a level disc is seen from the floor `x` metres beside where half a plane would end its shadow, and the
// penumbra is twice `half_width` wide: a circle, cut off by a straight line.
float visible(float x, float half_width) {
  const float c = std::clamp(x / half_width, -1.0f, 1.0f);
  return 0.5f + (std::asin(c) + c * std::sqrt(1.0f - c * c)) / pi;
}

// How far apart the columns lie that are seen to 20 % and to 80 %: 0.983 half widths, for a disc.
float width_m(const std::vector<float>& visible, float column_m) {
  const auto above = [&](float share) {
    return std::find_if(visible.begin(), visible.end(), [=](float v) { return v > share; }) - visible.begin();
  };
  return static_cast<float>(above(0.8f) - above(0.2f)) * column_m;
}

constexpr float d_init_m = 2.0f, seen_m = 1.06f;

// Half a plane, to the left of x = 0, hangs over the floor and below lights that form one cluster. `half_width` is that
// of the penumbra on the floor; `smooth_m` is how wide the map's resolution makes any edge.
void expect_penumbra(gpu::Device& device, const std::vector<pack::Light>& lights, float height_m, float half_width,
                     float smooth_m) {
  Scene scene = lone(level_square(glm::vec3(0.0f), 8));
  scene.add(quad({-4, height_m, 0}, {4, 0, 0}, {0, 0, -8}), 0);
  scene.lights = lights;
  const pack::File pack = scene.open();
  const World world(pack);
  Renderer renderer(device, world);
  // From below the half plane, always as much of the floor.
  const float eye_m = 0.999f * height_m;
  Camera camera = look({0, eye_m, 0}, {0, 0, 0}, 2.0f * std::atan(0.5f * seen_m / eye_m));
  camera.znear_m = 0.001f;
  const RenderSettings settings = settings_for(camera, size_px, size_px, clustered(Filter::pcss, d_init_m, 1024));
  const auto found = columns(frame(renderer, settings), frame(renderer, without_shadows(settings)));
  float worst = 0.0f;
  for (uint32_t x = 0; x < size_px; ++x)
    worst = std::max(worst, std::abs(found[x] - visible(floor_point(settings, x, size_px / 2).x, half_width)));
  const float width = width_m(found, seen_m / size_px);
  std::cout << "edge at " << height_m << " m: penumbra " << half_width << " m, 20 to 80 % " << width
            << " m, worst column off by " << worst << "\n";
  if (half_width < smooth_m) {  // contact hardening: no more than the smoothing that any edge has
    EXPECT_LT(width, smooth_m);
  } else {
    EXPECT_NEAR(width, 0.983f * half_width,
                0.1f * half_width + seen_m / size_px);  // a column is the least that is told
    EXPECT_LT(worst, 0.1f);
  }
}

TEST_F(BiasTest, PenumbraIsThatOfADiscLight) {
  const pack::Light lamp = point_light({0, 4, 0}, 30, 20);
  const frame::ShadowMap map =
      select_lights(world_of({{lamp}}), clustered(Filter::pcss, d_init_m, 1024), {}, 1.0f).maps[0];
  for (const float height_m : {0.02f, 0.5f, 1.0f, 1.5f, 2.0f})
    expect_penumbra(device(), {lamp}, height_m, map.filter_radius_m * height_m / (4.0f - height_m), 0.03f);
}

// Of its radius, where that is more than what stands for the cluster.
TEST_F(BiasTest, PenumbraIsThatOfALightWithARadius) {
  pack::Light lamp = point_light({0, 4, 0}, 30, 20);
  lamp.radius_m = 1.5f * d_init_m * 0.3f;
  for (const float height_m : {0.5f, 1.5f})
    expect_penumbra(device(), {lamp}, height_m, lamp.radius_m * height_m / (4.0f - height_m), 0.03f);
  pack::Light sun = directional_light({0, -1, 0}, 3);
  sun.radius_m = 0.02f;  // 2.3 degrees across
  for (const float height_m : {4.0f, 16.0f}) expect_penumbra(device(), {sun}, height_m, sun.radius_m * height_m, 0.06f);
}

// Two suns whose directions differ by less than d_init / z_far: the first is the brighter, and the centre.
TEST_F(BiasTest, PenumbraIsThatOfTwoSuns) {
  const std::vector<pack::Light> suns{directional_light({0, -1, 0}, 3),
                                      directional_light(glm::normalize(glm::vec3(0, -1, 0.01f)), 2)};
  const Recipe recipe = clustered(Filter::pcss, d_init_m, 1024);
  const LightList list = select_lights(world_of(suns), recipe, {}, 1.0f);
  ASSERT_EQ(list.maps.size(), 1u);
  for (const float height_m : {0.1f, 4.0f, 8.0f, 16.0f})
    expect_penumbra(device(), suns, height_m, list.maps[0].filter_radius_m * height_m / recipe.z_far_m, 0.06f);
}

}  // namespace
}  // namespace chandelier::test
