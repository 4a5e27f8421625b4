// SPDX-License-Identifier: Apache-2.0
// Rectangles of visibility textures: no pixel that sees into a sphere is left out, and few others are in.
#include "shadows/deliver/visibility_textures.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace chandelier {
namespace {

constexpr uint32_t width = 160, height = 90;

struct Drawn {
  Camera camera;
  glm::vec3 center_ws;
  float radius_m;
};

Drawn random_case(uint32_t seed) {
  std::mt19937 random(seed);
  const auto uniform = [&](float from, float to) {
    return from + (to - from) * static_cast<float>(random() >> 8) * 0x1p-24f;
  };
  const auto point = [&](float half) {
    return glm::vec3(uniform(-half, half), uniform(-half, half), uniform(-half, half));
  };
  Drawn drawn;
  drawn.camera.eye_ws = point(5.0f);
  drawn.camera.forward_ws = glm::normalize(point(1.0f) + glm::vec3(0, 0, 1e-3f));
  drawn.camera.yfov_rad = uniform(0.3f, 2.0f);
  drawn.center_ws = point(12.0f);
  drawn.radius_m = uniform(0.05f, 6.0f);
  return drawn;
}

// The way through a point of the picture.
glm::vec3 way(const Camera& camera, float x, float y) {
  const CameraAxes axes = axes_of(camera);
  const float edge = std::tan(camera.yfov_rad * 0.5f);
  return glm::normalize(axes.forward + axes.right * ((2.0f * x / width - 1.0f) * edge * width / height) -
                        axes.up * ((2.0f * y / height - 1.0f) * edge));
}

bool meets(const Drawn& drawn, const glm::vec3& direction) {
  const glm::vec3 d = drawn.center_ws - drawn.camera.eye_ws;
  const float along = std::max(0.0f, glm::dot(d, direction));
  return glm::length(d - direction * along) < drawn.radius_m;
}

TEST(VisibilityRectTest, HoldsEveryPixelThatSeesIntoTheSphere) {
  uint32_t partly = 0;
  for (uint32_t seed = 0; seed < 400; ++seed) {
    const Drawn drawn = random_case(seed);
    const PixelRect rect = sphere_rect(drawn.camera, width, height, drawn.center_ws, drawn.radius_m);
    ASSERT_LE(rect.x + rect.width, width);
    ASSERT_LE(rect.y + rect.height, height);
    uint32_t low_x = width, high_x = 0, low_y = height, high_y = 0;
    for (uint32_t y = 0; y < height; ++y) {
      for (uint32_t x = 0; x < width; ++x) {
        if (!meets(drawn, way(drawn.camera, static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f))) continue;
        ASSERT_TRUE(x >= rect.x && x < rect.x + rect.width && y >= rect.y && y < rect.y + rect.height)
            << "seed " << seed << ", pixel " << x << " " << y;
        low_x = std::min(low_x, x), high_x = std::max(high_x, x);
        low_y = std::min(low_y, y), high_y = std::max(high_y, y);
      }
    }
    const bool whole = rect.width == width && rect.height == height;
    if (low_x > high_x || whole) continue;
    ++partly;
    // Where the sphere is cut by the picture's edge the rectangle may be larger; each side by itself is tight.
    if (rect.x > 0 && low_y > 0 && high_y + 1 < height) {
      EXPECT_LE(low_x - rect.x, 4u) << "seed " << seed;
    }
    if (rect.y > 0 && low_x > 0 && high_x + 1 < width) {
      EXPECT_LE(low_y - rect.y, 4u) << "seed " << seed;
    }
  }
  EXPECT_GT(partly, 40u);
}

TEST(VisibilityRectTest, NothingBehindTheCamera) {
  const Camera camera;  // looks along -z
  EXPECT_EQ(sphere_rect(camera, width, height, {0, 0, 10}, 3.0f).width, 0u);
  EXPECT_EQ(sphere_rect(camera, width, height, {0, 0, -1}, 1.5f).width, width);  // the eye is in it
}

TEST(VisibilityRectTest, ADirectionalLightReachesEverything) {
  LightList list;
  list.maps = {{.projection = frame::Projection::cascade}, {.center_ws = {0, 0, -10}, .range_m = 1.0f}};
  place_visibility_rects(list, {}, width, height);
  EXPECT_EQ(visibility_bytes(list.maps[0]), width * height);
  EXPECT_GT(visibility_bytes(list.maps[1]), 50u);
  EXPECT_LT(visibility_bytes(list.maps[1]), 1000u);
}

}  // namespace
}  // namespace chandelier
