// SPDX-License-Identifier: Apache-2.0
// Several samples in a pixel: coverage at edges, what bright lamps do there, and that nothing else changes.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "frame/renderer.h"
#include "gpu_test.h"
#include "scene_builder.h"
#include "shading/targets.h"

namespace chandelier::test {
namespace {

constexpr uint32_t width = 64, height = 48, samples = 4;

struct Frame {
  Picture picture;
  FrameStats stats;
};

class EdgesTest : public GpuTest {
 protected:
  void SetUp() override {
    if (!can_draw_samples(device(), samples)) GTEST_SKIP() << "this device draws one sample in a pixel alone";
  }
  static Frame frame(const Scene& scene, RenderSettings settings, uint32_t in_pixel) {
    const pack::File pack = scene.open();
    const World world(pack);
    Renderer renderer(device(), world);
    settings.samples = in_pixel;
    const FrameStats stats = renderer.draw(settings);
    return {renderer.read_back(), stats};
  }
};

Recipe recipe_with(Filter filter, Lookup lookup) {
  Recipe recipe;
  recipe.filter = filter;
  recipe.lookup = lookup;
  recipe.face_size_px = 128;
  return recipe;
}

RenderSettings from_front(const Recipe& recipe = {}) {
  return settings_for(look({0, 0, 0}, {0, 0, -1}, 1.0f), width, height, recipe);
}

// A wall at z = -4 that ends at a line, `angle` from upright and `offset_m` from the middle of the view.
struct HalfPlane {
  float angle;
  float offset_m;
  glm::vec3 across() const { return {std::cos(angle), std::sin(angle), 0}; }
  Mesh mesh() const {
    const glm::vec3 u = across(), v(-u.y, u.x, 0);
    return quad(glm::vec3(0, 0, -4) + u * (offset_m - 20.0f), u * 20.0f, v * 20.0f);
  }
  // The part of a pixel that it covers, by 32 x 32 points.
  float coverage(const RenderSettings& settings, uint32_t x, uint32_t y) const {
    constexpr uint32_t points = 32;
    const float edge = std::tan(settings.camera.yfov_rad * 0.5f);
    uint32_t inside = 0;
    for (uint32_t i = 0; i < points * points; ++i) {
      const float px = static_cast<float>(x) + (static_cast<float>(i % points) + 0.5f) / points;
      const float py = static_cast<float>(y) + (static_cast<float>(i / points) + 0.5f) / points;
      const glm::vec2 tangent((px / width * 2 - 1) * edge * aspect_of(settings), (1 - py / height * 2) * edge);
      inside += 4.0f * glm::dot(tangent, glm::vec2(across())) < offset_m;
    }
    return static_cast<float>(inside) / (points * points);
  }
};

Scene half_plane_scene(const HalfPlane& wall) {
  Scene scene;
  scene.add(wall.mesh(), scene.add_material(plain_material(glm::vec3(1.0f))));
  return scene;
}

// Things before a floor, with lamps that cast shadows.
Scene room() {
  Scene scene;
  const uint32_t white = scene.add_material(plain_material(glm::vec3(0.7f)));
  const uint32_t red = scene.add_material(plain_material({0.7f, 0.1f, 0.1f}, 0.0f, 0.4f));
  scene.add(level_square({0, 0, 0}, 5), white);
  scene.add(box({-1.2f, 0.2f, -0.7f}, {-0.2f, 1.2f, 0.3f}), red);
  scene.add(sphere({0.8f, 0.8f, 0}, 0.6f, 24), white);
  for (uint32_t i = 0; i < 6; ++i)
    scene.lights.push_back(
        point_light({0.7f * static_cast<float>(i) - 1.7f, 2.2f, 1.0f - 0.3f * static_cast<float>(i)}, 4, 3));
  return scene;
}

RenderSettings room_settings(Filter filter, Lookup lookup) {
  return settings_for(look({1.5f, 2.0f, 4}, {0, 0.5f, 0}, 0.8f), width, height, recipe_with(filter, lookup));
}

float from_srgb(uint8_t value) {
  const float v = static_cast<float>(value) / 255.0f;
  return v <= 0.04045f ? v / 12.92f : std::pow((v + 0.055f) / 1.055f, 2.4f);
}

TEST_F(EdgesTest, WallWithoutEdgesIsAsWithOneSample) {
  Scene scene;
  const Mesh triangle{.vertices = {{{-40, -30, -4}, {0, 0, 1}, {0, 0}},
                                   {{40, -30, -5}, {0, 0, 1}, {1, 0}},
                                   {{0, 60, -4}, {0, 0, 1}, {0, 1}}},
                      .indices = {0, 1, 2}};
  scene.add(triangle, scene.add_material(plain_material(glm::vec3(0.5f))));
  scene.add(box({-0.4f, -0.3f, -2}, {-0.3f, 0.3f, -1.9f}), scene.add_material(plain_material(glm::vec3(0.5f))));
  scene.lights.push_back(point_light({-0.9f, 0, -1}, 5, 9));
  for (const Filter filter : {Filter::hard, Filter::pcss}) {
    // From beside the box, whose shadow is seen but not the box.
    RenderSettings settings =
        settings_for(look({1.2f, 0, -1}, {1.5f, 0, -4}, 0.6f), width, height, recipe_with(filter, Lookup::tiles));
    const Frame one = frame(scene, settings, 1), four = frame(scene, settings, samples);
    EXPECT_EQ(four.stats.edge_surfaces, 0u);
    // To the rounding of depth: a fragment's own and the one that the rasterizer keeps differ in the last bit on
    // lavapipe.
    for (size_t i = 0; i < one.picture.radiance.size(); ++i)
      EXPECT_NEAR(one.picture.radiance[i], four.picture.radiance[i], 1e-6f);
    EXPECT_EQ(one.picture.shown, four.picture.shown);
    EXPECT_GT(four.stats.sample_bytes, 0u);
    EXPECT_EQ(one.stats.sample_bytes, 0u);
  }
}

TEST_F(EdgesTest, CoverageOfAHalfPlane) {
  for (const HalfPlane wall : {HalfPlane{0.3f, 0.1f}, HalfPlane{1.2f, -0.3f}, HalfPlane{0.02f, 0.013f}}) {
    RenderSettings settings = from_front();
    settings.ambient = Ambient::constant(1.0f);
    const Frame found = frame(half_plane_scene(wall), settings, samples);
    uint32_t partly = 0;
    for (uint32_t y = 0; y < height; ++y)
      for (uint32_t x = 0; x < width; ++x) {
        const float covered = radiance_at(found.picture, x, y).x;
        // Four points err by up to 0.27 over all half-planes.
        EXPECT_NEAR(covered, wall.coverage(settings, x, y), 1.0f / samples + 0.03f) << x << ' ' << y;
        partly += covered > 0.1f && covered < 0.9f;
      }
    EXPECT_GT(partly, 30u);
    EXPECT_GE(found.stats.edge_pixels, partly);
  }
}

// In the middle of a pixel that a floor's horizon runs through, the floor's plane is behind the eye.
TEST_F(EdgesTest, AHorizonCoversPartOfItsPixels) {
  Scene scene;
  scene.add(level_square({0, 0, 0}, 40000), scene.add_material(plain_material(glm::vec3(0.8f))));
  scene.lights = {directional_light({0, -1, 0}, 3)};
  RenderSettings settings = from_front({.shade = Shade::lambert, .face_size_px = 128});
  const float pixel = 2.0f * std::tan(0.5f * settings.camera.yfov_rad) / height;
  for (const float below : {0.3f, 0.45f, 0.55f, 0.8f}) {  // of a pixel's row is floor
    settings.camera = look({0, 0.3f, 0}, {0, 0.3f - below * pixel, -1}, settings.camera.yfov_rad);
    const Picture picture = frame(scene, settings, samples).picture;
    const float floor = radiance_at(picture, 5, height - 5).x;
    ASSERT_GT(floor, 0.1f);
    for (uint32_t x = 0; x < width; ++x) {
      EXPECT_EQ(radiance_at(picture, x, height / 2 - 2).x, 0.0f);
      EXPECT_NEAR(radiance_at(picture, x, height / 2 - 1).x / floor, below, 0.28f) << below << " at " << x;
    }
  }
}

TEST_F(EdgesTest, ALampInPartOfAPixelMakesThatPartWhite) {
  constexpr float lamp = 1e4f, wall = 0.1f;
  Scene scene;
  pack::Material shining = plain_material(glm::vec3(0.0f));
  shining.emissive = glm::vec3(lamp);
  scene.add(HalfPlane{0.3f, 0.1f}.mesh(), scene.add_material(shining));
  scene.add(quad({0, 0, -6}, {30, 0, 0}, {0, 30, 0}), scene.add_material(plain_material(glm::vec3(wall))));
  RenderSettings settings = from_front();
  settings.ambient = Ambient::constant(1.0f);
  const Picture found = frame(scene, settings, samples).picture;
  const float dark = from_srgb(found.shown[4 * (width - 1)]);
  uint32_t quarters = 0;
  for (size_t i = 0; i < size_t{width} * height; ++i) {
    const float part = (found.radiance[4 * i] - wall) / (lamp - wall);
    EXPECT_NEAR(part * samples, std::round(part * samples), 1e-3f);  // linear: the mean of its samples
    EXPECT_NEAR(from_srgb(found.shown[4 * i]), part + (1 - part) * dark, 0.01f);
    quarters += part > 0.2f && part < 0.3f;
  }
  EXPECT_GT(quarters, 5u);
}

TEST_F(EdgesTest, IsNearerToAFinerPicture) {
  RenderSettings settings = without_shadows(room_settings(Filter::hard, Lookup::tiles));
  const Scene scene = room();
  RenderSettings fine = settings;
  fine.width = 8 * width;
  fine.height = 8 * height;
  const Picture truth = frame(scene, fine, 1).picture;
  const auto error = [&](const Picture& picture) {
    double sum = 0.0;
    for (uint32_t y = 0; y < height; ++y)
      for (uint32_t x = 0; x < width; ++x) {
        float mean = 0.0f;
        for (uint32_t i = 0; i < 64; ++i) mean += radiance_at(truth, 8 * x + i % 8, 8 * y + i / 8).x / 64.0f;
        sum += std::pow(mean - radiance_at(picture, x, y).x, 2.0f);
      }
    return std::sqrt(sum / (width * height));
  };
  EXPECT_LT(error(frame(scene, settings, samples).picture), 0.6 * error(frame(scene, settings, 1).picture));
}

TEST_F(EdgesTest, TilesFindAllLightsOfEdgesAndPicturesRepeat) {
  for (const Filter filter : {Filter::hard, Filter::pcf, Filter::pcss}) {
    const Frame all = frame(room(), room_settings(filter, Lookup::all), samples);
    const Frame tiles = frame(room(), room_settings(filter, Lookup::tiles), samples);
    EXPECT_EQ(all.picture.radiance, tiles.picture.radiance);
    const Frame again = frame(room(), room_settings(filter, Lookup::tiles), samples);
    EXPECT_EQ(tiles.picture.radiance, again.picture.radiance);
    EXPECT_EQ(tiles.picture.shown, again.picture.shown);
    EXPECT_EQ(tiles.stats.edge_surfaces, again.stats.edge_surfaces);
    EXPECT_GT(tiles.stats.edge_surfaces, tiles.stats.edge_pixels);
  }
}

TEST_F(EdgesTest, EveryDeliveryLightsEdges) {
  RenderSettings inlined = room_settings(Filter::pcss, Lookup::tiles), textures = inlined;
  textures.recipe.deliver = Deliver::textures;
  const Picture a = frame(room(), inlined, samples).picture, b = frame(room(), textures, samples).picture;
  for (size_t i = 0; i < a.radiance.size(); ++i) EXPECT_NEAR(a.radiance[i], b.radiance[i], 0.01f);
  // Lamps that cast no shadow, and lamps whose rays all arrive, in one group of maps or many.
  Scene open = room();
  for (pack::Light& light : open.lights) light.shadowless = 1;
  const Picture lit = frame(open, inlined, samples).picture;
  const RenderSettings rays = without_shadows(room_settings(Filter::hard, Lookup::tiles));
  EXPECT_EQ(lit.radiance, frame(room(), rays, samples).picture.radiance);
}

TEST_F(EdgesTest, OtherNumbersOfSamplesAreRefused) {
  EXPECT_THROW(frame(room(), room_settings(Filter::hard, Lookup::all), 3), gpu::Error);
  EXPECT_THROW(frame(room(), room_settings(Filter::hard, Lookup::all), 0), gpu::Error);
}

}  // namespace
}  // namespace chandelier::test
