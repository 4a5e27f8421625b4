// SPDX-License-Identifier: Apache-2.0
// What tests on a real Vulkan device share: the device, silence of the validation layer, cameras and pictures.
#pragma once

#include <gtest/gtest.h>

#include <cstdint>

#include "frame/renderer.h"
#include "scene_builder.h"

namespace chandelier::test {

/// One device for all tests of an executable, with synchronization validation. Each test fails on any message.
class GpuTest : public testing::Test {
 protected:
  static gpu::Device& device();
  void TearDown() override;
};

/// A camera that looks from `eye` to `target`.
Camera look(const glm::vec3& eye, const glm::vec3& target, float yfov_rad);

/// A picture of `width` by `height`, with the recipe's other settings as the tests want them: no ambient, exposure 0.
RenderSettings settings_for(const Camera& camera, uint32_t width, uint32_t height, const Recipe& recipe);

/// The same where everything that faces a light is lit by it.
RenderSettings without_shadows(RenderSettings settings);

Picture draw(gpu::Device& device, const Scene& scene, const RenderSettings& settings);

glm::vec3 radiance_at(const Picture& picture, uint32_t x, uint32_t y);

/// The way through the middle of a pixel, unit length, without the runtime's matrices.
glm::vec3 pixel_direction(const RenderSettings& settings, uint32_t x, uint32_t y);

/// Where that way meets the level plane at height 0, which must be below the eye's horizon.
glm::vec3 floor_point(const RenderSettings& settings, uint32_t x, uint32_t y);

}  // namespace chandelier::test
