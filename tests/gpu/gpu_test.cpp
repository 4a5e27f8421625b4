// SPDX-License-Identifier: Apache-2.0
// What tests on a real Vulkan device share: the device, silence of the validation layer, cameras and pictures.
#include "gpu_test.h"

#include <algorithm>
#include <cmath>
#include <iostream>

namespace chandelier::test {
namespace {

std::unique_ptr<gpu::Device> the_device;

// Ends the device while main still runs, not among static destructors; what was not freed before it is reported then.
class DeviceEnvironment : public testing::Environment {
 public:
  void TearDown() override {
    if (!the_device) return;
    const auto log = the_device->validation_log();
    const size_t told = log->size();
    the_device.reset();
    for (size_t i = told; i < log->size(); ++i) ADD_FAILURE() << (*log)[i];
  }
};
const testing::Environment* const environment = testing::AddGlobalTestEnvironment(new DeviceEnvironment);

}  // namespace

gpu::Device& GpuTest::device() {
  if (!the_device) {
    the_device = std::make_unique<gpu::Device>(gpu::DeviceOptions{.device = {}, .validation = true});
    std::cout << "device: " << the_device->name << ", " << the_device->driver << "\n";
  }
  return *the_device;
}

void GpuTest::TearDown() {
  if (!the_device) return;
  static size_t told = 0;
  const auto& messages = the_device->validation_messages();
  for (; told < messages.size(); ++told) ADD_FAILURE() << messages[told];
}

Camera look(const glm::vec3& eye, const glm::vec3& target, float yfov_rad) {
  Camera camera;
  camera.eye_ws = eye;
  camera.forward_ws = glm::normalize(target - eye);
  camera.up_ws = std::abs(camera.forward_ws.y) < 0.99f ? glm::vec3(0, 1, 0) : glm::vec3(0, 0, -1);
  camera.yfov_rad = yfov_rad;
  return camera;
}

RenderSettings settings_for(const Camera& camera, uint32_t width, uint32_t height, const Recipe& recipe) {
  RenderSettings settings;
  settings.recipe = recipe;
  settings.camera = camera;
  settings.width = width;
  settings.height = height;
  settings.exposure_ev = 0.0f;
  return settings;
}

RenderSettings without_shadows(RenderSettings settings) {
  settings.recipe.select = Select::per_light;
  settings.recipe.filter = Filter::rays;
  settings.recipe.deliver = Deliver::textures;
  settings.visibility = [](const VisibilityQuery& query) { std::ranges::fill(query.visibility, uint8_t{255}); };
  return settings;
}

Picture draw(gpu::Device& device, const Scene& scene, const RenderSettings& settings) {
  const pack::File pack = scene.open();
  const World world(pack);
  Renderer renderer(device, world);
  renderer.draw(settings);
  return renderer.read_back();
}

glm::vec3 radiance_at(const Picture& picture, uint32_t x, uint32_t y) {
  const float* texel = &picture.radiance[(size_t{y} * picture.width + x) * 4];
  return {texel[0], texel[1], texel[2]};
}

glm::vec3 pixel_direction(const RenderSettings& settings, uint32_t x, uint32_t y) {
  const Camera& camera = settings.camera;
  const glm::vec3 right = glm::normalize(glm::cross(camera.forward_ws, camera.up_ws));
  const glm::vec3 up = glm::cross(right, camera.forward_ws);
  const float height = static_cast<float>(settings.height);
  const float metres_per_pixel = 2.0f * std::tan(0.5f * camera.yfov_rad) / height;  // one metre ahead
  const float across = (static_cast<float>(x) + 0.5f - 0.5f * static_cast<float>(settings.width)) * metres_per_pixel;
  const float upwards = (0.5f * height - static_cast<float>(y) - 0.5f) * metres_per_pixel;
  return glm::normalize(camera.forward_ws + right * across + up * upwards);
}

glm::vec3 floor_point(const RenderSettings& settings, uint32_t x, uint32_t y) {
  const glm::vec3 direction = pixel_direction(settings, x, y);
  return settings.camera.eye_ws + direction * (-settings.camera.eye_ws.y / direction.y);
}

}  // namespace chandelier::test
