// SPDX-License-Identifier: Apache-2.0
// Ambient light by direction: shader and CPU agree, and rooms look as the closed form says.
#include <cmath>
#include <cstring>
#include <random>

#include "frame_schema.h"
#include "gpu/pipelines.h"
#include "gpu_test.h"
#include "shaders/ambient_comp.h"

namespace chandelier::test {
namespace {

constexpr uint32_t size_px = 32;
constexpr float base = 0.5f;

class AmbientTest : public GpuTest {
 protected:
  template <typename T>
  static gpu::Buffer upload(std::span<const T> values) {
    gpu::Buffer buffer =
        gpu::make_buffer(device(), values.size_bytes(), VK_BUFFER_USAGE_STORAGE_BUFFER_BIT, gpu::Memory::readback);
    std::memcpy(buffer.mapped, values.data(), values.size_bytes());
    return buffer;
  }
};

Ambient any_ambient(uint32_t seed) {
  std::mt19937 random(seed);
  Ambient ambient;
  for (size_t i = 0; i < 9; ++i)
    for (int c = 0; c < 3; ++c)
      ambient.coefficients[i][c] = (i == 0 ? 2.0f : -0.5f) + static_cast<float>(random() >> 8) * 0x1p-24f;
  return ambient;
}

TEST_F(AmbientTest, ShaderAndCpuAgree) {
  std::mt19937 random(1);
  std::vector<glm::vec3> normals;
  const auto coordinate = [&] { return static_cast<float>(random() >> 8) * 0x1p-23f - 1.0f; };
  while (normals.size() < 512) {
    const glm::vec3 v(coordinate(), coordinate(), coordinate());
    if (glm::dot(v, v) > 0.01f) normals.push_back(glm::normalize(v));
  }
  for (const Ambient& ambient : {any_ambient(2), Ambient::between(3.0f, 0.5f), Ambient::constant(0.3f)}) {
    const frame::ViewConstants constants{.ambient = ambient.coefficients};
    const gpu::Buffer view = upload(std::span(&constants, 1)), asked = upload(std::span<const glm::vec3>(normals)),
                      answers = upload(std::span<const glm::vec3>(normals));
    const gpu::Pipeline pipeline = gpu::make_compute_pipeline(device(), ambient_comp);
    gpu::run_once(device(), [&](gpu::Commands cmd) {
      gpu::bind(cmd, pipeline,
                {{"View", gpu::storage(view)}, {"Normals", gpu::storage(asked)}, {"Answers", gpu::storage(answers)}});
      gpu::dispatch(cmd, device(), pipeline, normals.size());
      gpu::memory_barrier(cmd, VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT, VK_ACCESS_2_SHADER_STORAGE_WRITE_BIT,
                          VK_PIPELINE_STAGE_2_HOST_BIT, VK_ACCESS_2_HOST_READ_BIT);
    });
    for (size_t i = 0; i < normals.size(); ++i) {
      glm::vec3 found;
      std::memcpy(&found, answers.mapped + i * sizeof(found), sizeof(found));
      const glm::vec3 expected = ambient.at(normals[i]);
      for (int c = 0; c < 3; ++c) ASSERT_NEAR(found[c], expected[c], 2e-6f) << i;
      if (ambient.is_constant()) {
        ASSERT_EQ(found, expected);
      }
    }
  }
}

/// The middle of what is seen of one side of a cube, of which `toward` is the way to it.
glm::vec3 side_of_room(gpu::Device& device, const glm::vec3& toward, const Ambient& ambient) {
  Scene scene;
  Mesh room = box(glm::vec3(-1.0f), glm::vec3(1.0f));
  for (size_t i = 0; i < room.indices.size(); i += 3) std::swap(room.indices[i + 1], room.indices[i + 2]);
  for (Vertex& vertex : room.vertices) vertex.normal = -vertex.normal;
  scene.add(room, scene.add_material(plain_material(glm::vec3(base))));
  RenderSettings settings = settings_for(look(glm::vec3(0.0f), toward, 0.9f), size_px, size_px, Recipe());
  settings.ambient = ambient;
  return radiance_at(draw(device, scene, settings), size_px / 2, size_px / 2);
}

TEST_F(AmbientTest, FloorWallAndCeilingAreAsBrightAsTheClosedForm) {
  const Ambient ambient = Ambient::between(3.0f, 0.5f);
  const auto expect = [&](const glm::vec3& toward, float expected) {
    const glm::vec3 found = side_of_room(device(), toward, ambient);
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(found[c], base * expected, 2e-4f) << toward.y;
  };
  expect({0, -1, 0}, 1.75f + 2.0f / 3.0f * 1.25f);  // the floor looks up
  expect({0, 1, 0}, 1.75f - 2.0f / 3.0f * 1.25f);
  for (const glm::vec3& wall : {glm::vec3(1, 0, 0), glm::vec3(-1, 0, 0), glm::vec3(0, 0, 1), glm::vec3(0, 0, -1)})
    expect(wall, 1.75f);
}

TEST_F(AmbientTest, EverySideOfARoomGetsTheLightOfItsNormal) {
  const Ambient ambient = any_ambient(3);
  for (const glm::vec3& toward : {glm::vec3(1, 0, 0), glm::vec3(-1, 0, 0), glm::vec3(0, 1, 0), glm::vec3(0, -1, 0),
                                  glm::vec3(0, 0, 1), glm::vec3(0, 0, -1)}) {
    const glm::vec3 found = side_of_room(device(), toward, ambient), expected = base * ambient.at(-toward);
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(found[c], expected[c], 2e-4f);
  }
}

TEST_F(AmbientTest, ConstantLightIsExact) {
  EXPECT_EQ(side_of_room(device(), {0, 0, -1}, Ambient::constant(0.3f)), glm::vec3(0.3f * base));
}

}  // namespace
}  // namespace chandelier::test
