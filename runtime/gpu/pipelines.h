// SPDX-License-Identifier: Apache-2.0
// Pipelines whose set 0 is pushed: a pass names its resources where it is recorded.
#pragma once

#include <initializer_list>
#include <span>
#include <vector>

#include "gpu/resources.h"

namespace chandelier::gpu {

/// One binding's resource, in binding order. Make them with the functions below.
struct Bound {
  VkDescriptorType type;
  VkDescriptorBufferInfo buffer{};
  VkDescriptorImageInfo image{};
};
Bound storage(const Buffer& buffer);
Bound sampled(VkImageView view, VkSampler sampler, VkImageLayout layout = VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL);
Bound storage_image(const Image& image);

struct Pipeline {
  Owned<VkDescriptorSetLayout> set_layout;
  Owned<VkPipelineLayout> layout;
  Owned<VkPipeline> handle;
  VkPipelineBindPoint bind_point = VK_PIPELINE_BIND_POINT_GRAPHICS;
};

/// `bindings[i]` is binding i of set 0; `push_bytes` of push constants; `more_sets` follow set 0.
struct LayoutInfo {
  std::vector<VkDescriptorType> bindings;
  uint32_t push_bytes = 0;
  std::vector<VkDescriptorSetLayout> more_sets;
};

/// Specialization constants 0, 1, 2 … of every stage.
using Constants = std::vector<uint32_t>;

Pipeline make_compute_pipeline(const Device& device, const LayoutInfo& layout, std::span<const uint32_t> spirv,
                               const Constants& constants = {});

struct VertexStream {
  uint32_t stride_bytes;
  std::vector<VkVertexInputAttributeDescription> attributes;  // binding is filled in
};

struct GraphicsInfo {
  LayoutInfo layout;
  std::span<const uint32_t> vertex;
  std::span<const uint32_t> fragment;  // may be empty: depth only
  std::vector<VertexStream> streams;
  std::vector<VkFormat> colors;
  VkFormat depth = VK_FORMAT_UNDEFINED;
  Constants constants;
};
/// Triangle lists, reversed depth (greater passes), dynamic viewport, scissor and cull mode.
Pipeline make_graphics_pipeline(const Device& device, const GraphicsInfo& info);

/// Binds the pipeline and its set 0.
void bind(Commands cmd, const Pipeline& pipeline, std::initializer_list<Bound> resources);

void push_bytes(Commands cmd, const Pipeline& pipeline, std::span<const std::byte> bytes);
template <typename Constants>
void push_constants(Commands cmd, const Pipeline& pipeline, const Constants& constants) {
  push_bytes(cmd, pipeline, std::as_bytes(std::span(&constants, 1)));
}

/// Enough groups of `group` threads for `threads`, spread over y where x alone cannot hold them.
void dispatch(Commands cmd, const Device& device, uint64_t threads, uint32_t group);

}  // namespace chandelier::gpu
