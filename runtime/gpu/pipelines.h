// SPDX-License-Identifier: Apache-2.0
// Pipelines whose set 0 is pushed: a pass names its resources where it is recorded. What a pipeline takes is read from
// its shaders (gpu/shader.h).
#pragma once

#include <initializer_list>
#include <span>
#include <vector>

#include "gpu/resources.h"
#include "gpu/shader.h"

namespace chandelier::gpu {

/// One binding's resource. Make them with the functions below.
struct Bound {
  VkDescriptorType type;
  VkDescriptorBufferInfo buffer{};
  VkDescriptorImageInfo image{};
};
Bound storage(const Buffer& buffer);
Bound sampled(VkImageView view, VkSampler sampler, VkImageLayout layout = VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL);
Bound storage_image(const Image& image);

/// A resource and the binding that takes it, by its name in GLSL.
struct Resource {
  std::string_view name;
  Bound bound;
};

struct Pipeline {
  Shared<VkDescriptorSetLayout> set_layout;
  Shared<VkPipelineLayout> layout;
  Shared<VkPipeline> handle;
  VkPipelineBindPoint bind_point = VK_PIPELINE_BIND_POINT_GRAPHICS;
  std::string_view name;                 // of its first shader
  std::vector<Binding> bindings;         // of set 0, by all its shaders
  uint32_t push_bytes = 0;               // of push constants
  std::array<uint32_t, 3> local_size{};  // threads of a work group
};

/// A specialization constant's value, by its name in GLSL. Those that are not given keep what the shader says.
struct Constant {
  std::string_view name;
  uint32_t value;
};
using Constants = std::vector<Constant>;

/// Throws Error where the shader has no constant of a name. A device makes each pipeline once, and keeps it.
Pipeline make_compute_pipeline(const Device& device, const Shader& shader, const Constants& constants = {});

/// A part of a vertex, read by the vertex shader's input of that name.
struct VertexAttribute {
  std::string_view name;
  VkFormat format;
  uint32_t offset_bytes;
};
/// What the shader has no input for is not read.
struct VertexStream {
  uint32_t stride_bytes;
  std::vector<VertexAttribute> attributes;
};

struct GraphicsInfo {
  const Shader& vertex;
  const Shader* fragment = nullptr;              // absent: depth only
  std::vector<VkDescriptorSetLayout> more_sets;  // they follow set 0
  std::vector<VertexStream> streams;
  std::vector<VkFormat> colors;
  VkFormat depth = VK_FORMAT_UNDEFINED;
  Constants constants;
  uint32_t samples = 1;
};
/// Triangle lists, reversed depth (greater passes), dynamic viewport, scissor and cull mode. Throws Error where an
/// input of the vertex shader is in no stream, or no shader has a constant of a name.
Pipeline make_graphics_pipeline(const Device& device, const GraphicsInfo& info);

/// Binds the pipeline and its set 0. Throws Error unless each binding gets one resource, of its type.
void bind(Commands cmd, const Pipeline& pipeline, std::span<const Resource> resources);
inline void bind(Commands cmd, const Pipeline& pipeline, std::initializer_list<Resource> resources) {
  bind(cmd, pipeline, std::span(resources.begin(), resources.size()));
}

/// Throws Error unless they are as many bytes as the shaders declare.
void push_bytes(Commands cmd, const Pipeline& pipeline, std::span<const std::byte> bytes);
template <typename Constants>
void push_constants(Commands cmd, const Pipeline& pipeline, const Constants& constants) {
  push_bytes(cmd, pipeline, std::as_bytes(std::span(&constants, 1)));
}

/// Enough work groups, which are rows, for `threads`, spread over y where x alone cannot hold them.
void dispatch(Commands cmd, const Device& device, const Pipeline& pipeline, uint64_t threads);
/// A thread for each pixel of a picture, in work groups that are rectangles.
void dispatch_over(Commands cmd, const Pipeline& pipeline, uint32_t width, uint32_t height);
/// Covers an image `width` by `height` with viewport and scissor.
void set_viewport(Commands cmd, uint32_t width, uint32_t height);

}  // namespace chandelier::gpu
