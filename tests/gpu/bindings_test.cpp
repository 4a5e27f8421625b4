// SPDX-License-Identifier: Apache-2.0
// What is read from a shader's SPIR-V, and what is refused where a pass binds something else.
#include <functional>

#include "frame_schema.h"
#include "gpu/pipelines.h"
#include "gpu_test.h"
#include "shaders/bindings_comp.h"

namespace chandelier::test {
namespace {

constexpr auto buffer = VK_DESCRIPTOR_TYPE_STORAGE_BUFFER;

class BindingsTest : public GpuTest {
 protected:
  // What a test says is thrown while commands are recorded.
  static std::string refusal(const std::function<void(gpu::Commands)>& record) {
    try {
      gpu::run_once(device(), [&](gpu::Commands cmd) { record(cmd); });
    } catch (const gpu::Error& error) {
      return error.what();
    }
    return {};
  }
};

TEST_F(BindingsTest, AreReadFromSpirv) {
  const gpu::Shader& shader = bindings_comp;
  const std::vector<std::tuple<uint32_t, VkDescriptorType, std::string_view>> expected{
      {0, buffer, "named"},
      {2, VK_DESCRIPTOR_TYPE_STORAGE_IMAGE, "target"},
      {3, VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER, "Block"},
      {5, VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER, "picture"},
      {7, buffer, "Words"},
      {9, buffer, "Idle"}};
  ASSERT_EQ(shader.bindings.size(), expected.size());
  for (size_t i = 0; i < expected.size(); ++i) {
    const gpu::Binding& binding = shader.bindings[i];
    EXPECT_EQ(std::tuple(binding.number, binding.type, binding.name), expected[i]);
    EXPECT_EQ(binding.set, 0u);
    EXPECT_EQ(binding.is_used, binding.name != "Idle");
  }
  EXPECT_EQ(shader.name, "bindings_comp");
  EXPECT_EQ(shader.push_bytes, 12u + 3 * 4 + 2 * 12);
  EXPECT_EQ(shader.local_size, (std::array<uint32_t, 3>{8, 4, 1}));
  EXPECT_EQ(gpu::make_compute_pipeline(device(), shader).bindings.size(), expected.size());
}

// A pipeline of two buffers, made from the shader above by leaving out what is of another kind.
TEST_F(BindingsTest, WhatIsBoundHasToBeWhatTheShaderTakes) {
  const gpu::Binding two[]{{0, 0, buffer, "named"}, {0, 7, buffer, "Words"}, {0, 9, buffer, "Idle", false}};
  gpu::Pipeline pipeline;
  pipeline.name = "two";
  pipeline.bindings.assign(std::begin(two), std::end(two));
  pipeline.push_bytes = 8;
  const gpu::Buffer words = gpu::make_buffer(device(), 64, VK_BUFFER_USAGE_STORAGE_BUFFER_BIT, gpu::Memory::device);
  const gpu::Bound good = gpu::storage(words);
  gpu::Bound image = good;
  image.type = VK_DESCRIPTOR_TYPE_STORAGE_IMAGE;
  EXPECT_EQ(refusal([&](auto cmd) { gpu::bind(cmd, pipeline, {{"named", good}}); }), "two: Words: nothing is bound");
  EXPECT_EQ(refusal([&](auto cmd) {
              gpu::bind(cmd, pipeline, {{"Words", good}, {"Named", good}});
            }),
            "two: Named: there is no such binding");
  EXPECT_EQ(refusal([&](auto cmd) {
              gpu::bind(cmd, pipeline, {{"named", good}, {"Words", image}});
            }),
            "two: Words: what is bound is of another type");
  EXPECT_EQ(refusal([&](auto cmd) { gpu::push_constants(cmd, pipeline, 3.0f); }),
            "two: takes 8 bytes of push constants (4)");
}

TEST_F(BindingsTest, StagesOfAPipelineHaveToAgree) {
  const auto refused = [&](const gpu::Binding& in_vertex, const gpu::Binding& in_fragment) {
    gpu::Shader vertex{.name = "v"}, fragment{.name = "f"};
    vertex.bindings = {&in_vertex, 1};
    fragment.bindings = {&in_fragment, 1};
    try {
      gpu::make_graphics_pipeline(device(), {.vertex = vertex, .fragment = &fragment});
    } catch (const gpu::Error& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_EQ(refused({0, 1, buffer, "A"}, {0, 1, buffer, "B"}), "f: B: has the number of A in v");
  EXPECT_EQ(refused({0, 1, buffer, "A"}, {0, 1, VK_DESCRIPTOR_TYPE_STORAGE_IMAGE, "A"}),
            "f: A: has the number of A in v");
  EXPECT_EQ(refused({0, 1, buffer, "A"}, {1, 1, buffer, "B"}), "f: B: is in set 1, which has no layout");
  EXPECT_EQ(refused({0, 40, buffer, "A"}, {0, 1, buffer, "B"}), "v: A: has a number of 32 or more");
}

}  // namespace
}  // namespace chandelier::test
