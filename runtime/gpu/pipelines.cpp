// SPDX-License-Identifier: Apache-2.0
#include "gpu/pipelines.h"

#include <volk.h>

#include <algorithm>
#include <array>
#include <ranges>

#include "gpu/pipeline_cache.h"

namespace chandelier::gpu {
namespace {

constexpr uint32_t most_bindings = 32;  // the least that maxPushDescriptors may be

Owned<VkShaderModule> make_module(const Device& device, std::span<const uint32_t> spirv) {
  const VkShaderModuleCreateInfo info{
      .sType = VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO, .codeSize = spirv.size_bytes(), .pCode = spirv.data()};
  VkShaderModule module = VK_NULL_HANDLE;
  check(device->vkCreateShaderModule(device.handle, &info, nullptr, &module), "vkCreateShaderModule");
  return {device.handle, module, device->vkDestroyShaderModule};
}

// Stages of a graphics pipeline may share bindings, and then have to agree on them.
void add_shader(const Shader& shader, size_t sets, Pipeline& pipeline) {
  const auto fail = [&](const Binding& binding, const std::string& what) {
    throw Error(std::string(shader.name) + ": " + std::string(binding.name) + ": " + what);
  };
  for (const Binding& binding : shader.bindings) {
    if (binding.set >= sets) fail(binding, "is in set " + std::to_string(binding.set) + ", which has no layout");
    if (binding.set != 0) continue;
    if (binding.number >= most_bindings) fail(binding, "has a number of " + std::to_string(most_bindings) + " or more");
    const auto same = std::find_if(pipeline.bindings.begin(), pipeline.bindings.end(),
                                   [&](const Binding& other) { return other.number == binding.number; });
    if (same == pipeline.bindings.end())
      pipeline.bindings.push_back(binding);
    else if (same->type != binding.type || same->name != binding.name)
      fail(binding, "has the number of " + std::string(same->name) + " in " + std::string(pipeline.name));
    else
      same->is_used = same->is_used || binding.is_used;
  }
  pipeline.push_bytes = std::max(pipeline.push_bytes, shader.push_bytes);
}

void make_layout(const Device& device, std::span<const VkDescriptorSetLayout> more_sets, Pipeline& pipeline) {
  std::vector<VkDescriptorSetLayoutBinding> bindings;
  for (const Binding& binding : pipeline.bindings)
    bindings.push_back({.binding = binding.number,
                        .descriptorType = binding.type,
                        .descriptorCount = 1,
                        .stageFlags = VK_SHADER_STAGE_ALL});
  const VkDescriptorSetLayoutCreateInfo set_info{.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_CREATE_INFO,
                                                 .flags = VK_DESCRIPTOR_SET_LAYOUT_CREATE_PUSH_DESCRIPTOR_BIT_KHR,
                                                 .bindingCount = static_cast<uint32_t>(bindings.size()),
                                                 .pBindings = bindings.data()};
  VkDescriptorSetLayout set = VK_NULL_HANDLE;
  check(device->vkCreateDescriptorSetLayout(device.handle, &set_info, nullptr, &set), "vkCreateDescriptorSetLayout");
  pipeline.set_layout = Owned<VkDescriptorSetLayout>{device.handle, set, device->vkDestroyDescriptorSetLayout};

  std::vector<VkDescriptorSetLayout> sets{set};
  sets.insert(sets.end(), more_sets.begin(), more_sets.end());
  const VkPushConstantRange range{VK_SHADER_STAGE_ALL, 0, pipeline.push_bytes};
  const VkPipelineLayoutCreateInfo layout_info{.sType = VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO,
                                               .setLayoutCount = static_cast<uint32_t>(sets.size()),
                                               .pSetLayouts = sets.data(),
                                               .pushConstantRangeCount = pipeline.push_bytes ? 1u : 0u,
                                               .pPushConstantRanges = &range};
  VkPipelineLayout layout = VK_NULL_HANDLE;
  check(device->vkCreatePipelineLayout(device.handle, &layout_info, nullptr, &layout), "vkCreatePipelineLayout");
  pipeline.layout = Owned<VkPipelineLayout>{device.handle, layout, device->vkDestroyPipelineLayout};
}

const Named* named(std::span<const Named> all, std::string_view name) {
  const auto found = std::ranges::find(all, name, &Named::name);
  return found == all.end() ? nullptr : &*found;
}

// The constants that a shader has.
struct Specialization {
  std::vector<VkSpecializationMapEntry> entries;
  std::vector<uint32_t> values;
  VkSpecializationInfo info{};
  Specialization(const Shader& shader, const Constants& constants) {
    for (const Constant& constant : constants) {
      const Named* found = named(shader.constants, constant.name);
      if (!found) continue;
      entries.push_back({found->number, static_cast<uint32_t>(values.size() * 4), 4});
      values.push_back(constant.value);
    }
    info = {static_cast<uint32_t>(entries.size()), entries.data(), values.size() * 4, values.data()};
  }
  Specialization(const Specialization&) = delete;  // info points into it
  Specialization& operator=(const Specialization&) = delete;
};

void check_constants(const Constants& constants, const Shader& shader, const Shader* other = nullptr) {
  for (const Constant& constant : constants)
    if (!named(shader.constants, constant.name) && !(other && named(other->constants, constant.name)))
      throw Error(std::string(shader.name) + ": there is no constant " + std::string(constant.name));
}

struct VertexInput {
  std::vector<VkVertexInputBindingDescription> streams;
  std::vector<VkVertexInputAttributeDescription> attributes;
};

VertexInput vertex_input(const Shader& vertex, std::span<const VertexStream> streams) {
  VertexInput input;
  for (const VertexStream& stream : streams) {
    const auto binding = static_cast<uint32_t>(input.streams.size());
    input.streams.push_back({binding, stream.stride_bytes, VK_VERTEX_INPUT_RATE_VERTEX});
    for (const VertexAttribute& attribute : stream.attributes)
      if (const Named* found = named(vertex.inputs, attribute.name))
        input.attributes.push_back({found->number, binding, attribute.format, attribute.offset_bytes});
  }
  for (const Named& needed : vertex.inputs)
    if (std::ranges::find(input.attributes, needed.number, &VkVertexInputAttributeDescription::location) ==
        input.attributes.end())
      throw Error(std::string(vertex.name) + ": " + std::string(needed.name) + ": is in no vertex stream");
  return input;
}

VkPipelineShaderStageCreateInfo stage(VkShaderStageFlagBits which, VkShaderModule module,
                                      const Specialization& constants) {
  return {.sType = VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO,
          .stage = which,
          .module = module,
          .pName = "main",
          .pSpecializationInfo = &constants.info};
}

}  // namespace

Bound storage(const Buffer& buffer) {
  return {.type = VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, .buffer = {buffer.handle, 0, VK_WHOLE_SIZE}};
}

Bound sampled(VkImageView view, VkSampler sampler, VkImageLayout layout) {
  return {.type = VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER, .image = {sampler, view, layout}};
}

Bound storage_image(const Image& image) {
  return {.type = VK_DESCRIPTOR_TYPE_STORAGE_IMAGE, .image = {VK_NULL_HANDLE, image.view, VK_IMAGE_LAYOUT_GENERAL}};
}

namespace {

Pipeline compile(const Device& device, const Shader& shader, const Specialization& specialization) {
  Pipeline pipeline{.bind_point = VK_PIPELINE_BIND_POINT_COMPUTE, .name = shader.name, .local_size = shader.local_size};
  add_shader(shader, 1, pipeline);
  make_layout(device, {}, pipeline);
  const auto module = make_module(device, shader.words);
  const VkComputePipelineCreateInfo info{.sType = VK_STRUCTURE_TYPE_COMPUTE_PIPELINE_CREATE_INFO,
                                         .stage = stage(VK_SHADER_STAGE_COMPUTE_BIT, module, specialization),
                                         .layout = pipeline.layout};
  VkPipeline handle = VK_NULL_HANDLE;
  check(device->vkCreateComputePipelines(device.handle, VK_NULL_HANDLE, 1, &info, nullptr, &handle),
        "vkCreateComputePipelines");
  pipeline.handle = Owned<VkPipeline>{device.handle, handle, device->vkDestroyPipeline};
  return pipeline;
}

}  // namespace

Pipeline make_compute_pipeline(const Device& device, const Shader& shader, const Constants& constants) {
  check_constants(constants, shader);
  const Specialization specialization(shader, constants);
  PipelineCache::Key key{shader.words.data(), {}};
  for (size_t i = 0; i < specialization.values.size(); ++i)
    key.second.emplace_back(specialization.entries[i].constantID, specialization.values[i]);
  std::ranges::sort(key.second);
  PipelineCache& made = device.pipelines();
  const std::scoped_lock lock(made.mutex);
  const auto found = made.compute.find(key);
  if (found != made.compute.end()) return found->second;
  return made.compute.emplace(key, compile(device, shader, specialization)).first->second;
}

Pipeline make_graphics_pipeline(const Device& device, const GraphicsInfo& in) {
  Pipeline pipeline{.name = in.vertex.name};
  add_shader(in.vertex, in.more_sets.size() + 1, pipeline);
  if (in.fragment) add_shader(*in.fragment, in.more_sets.size() + 1, pipeline);
  make_layout(device, in.more_sets, pipeline);
  check_constants(in.constants, in.vertex, in.fragment);
  const Specialization of_vertex(in.vertex, in.constants);
  const Specialization of_fragment(in.fragment ? *in.fragment : in.vertex, in.constants);
  const auto vertex = make_module(device, in.vertex.words);
  Owned<VkShaderModule> fragment;
  std::vector<VkPipelineShaderStageCreateInfo> stages{stage(VK_SHADER_STAGE_VERTEX_BIT, vertex, of_vertex)};
  if (in.fragment) {
    fragment = make_module(device, in.fragment->words);
    stages.push_back(stage(VK_SHADER_STAGE_FRAGMENT_BIT, fragment, of_fragment));
  }

  const VertexInput input = vertex_input(in.vertex, in.streams);
  const VkPipelineVertexInputStateCreateInfo input_info{
      .sType = VK_STRUCTURE_TYPE_PIPELINE_VERTEX_INPUT_STATE_CREATE_INFO,
      .vertexBindingDescriptionCount = static_cast<uint32_t>(input.streams.size()),
      .pVertexBindingDescriptions = input.streams.data(),
      .vertexAttributeDescriptionCount = static_cast<uint32_t>(input.attributes.size()),
      .pVertexAttributeDescriptions = input.attributes.data()};
  const VkPipelineInputAssemblyStateCreateInfo assembly{
      .sType = VK_STRUCTURE_TYPE_PIPELINE_INPUT_ASSEMBLY_STATE_CREATE_INFO,
      .topology = VK_PRIMITIVE_TOPOLOGY_TRIANGLE_LIST};
  const VkPipelineViewportStateCreateInfo viewport{
      .sType = VK_STRUCTURE_TYPE_PIPELINE_VIEWPORT_STATE_CREATE_INFO, .viewportCount = 1, .scissorCount = 1};
  const VkPipelineRasterizationStateCreateInfo raster{
      .sType = VK_STRUCTURE_TYPE_PIPELINE_RASTERIZATION_STATE_CREATE_INFO,
      .polygonMode = VK_POLYGON_MODE_FILL,
      .frontFace = VK_FRONT_FACE_COUNTER_CLOCKWISE,
      .lineWidth = 1.0f};
  const VkPipelineMultisampleStateCreateInfo samples{
      .sType = VK_STRUCTURE_TYPE_PIPELINE_MULTISAMPLE_STATE_CREATE_INFO,
      .rasterizationSamples = static_cast<VkSampleCountFlagBits>(in.samples)};
  const VkPipelineDepthStencilStateCreateInfo depth{.sType = VK_STRUCTURE_TYPE_PIPELINE_DEPTH_STENCIL_STATE_CREATE_INFO,
                                                    .depthTestEnable = VK_TRUE,
                                                    .depthWriteEnable = VK_TRUE,
                                                    .depthCompareOp = VK_COMPARE_OP_GREATER};
  const std::vector<VkPipelineColorBlendAttachmentState> blends(in.colors.size(), {.colorWriteMask = 0xF});
  const VkPipelineColorBlendStateCreateInfo blend{.sType = VK_STRUCTURE_TYPE_PIPELINE_COLOR_BLEND_STATE_CREATE_INFO,
                                                  .attachmentCount = static_cast<uint32_t>(blends.size()),
                                                  .pAttachments = blends.data()};
  constexpr VkDynamicState dynamic_states[]{VK_DYNAMIC_STATE_VIEWPORT, VK_DYNAMIC_STATE_SCISSOR,
                                            VK_DYNAMIC_STATE_CULL_MODE};
  const VkPipelineDynamicStateCreateInfo dynamic{.sType = VK_STRUCTURE_TYPE_PIPELINE_DYNAMIC_STATE_CREATE_INFO,
                                                 .dynamicStateCount = 3,
                                                 .pDynamicStates = dynamic_states};
  const VkPipelineRenderingCreateInfo rendering{.sType = VK_STRUCTURE_TYPE_PIPELINE_RENDERING_CREATE_INFO,
                                                .colorAttachmentCount = static_cast<uint32_t>(in.colors.size()),
                                                .pColorAttachmentFormats = in.colors.data(),
                                                .depthAttachmentFormat = in.depth};
  const VkGraphicsPipelineCreateInfo info{.sType = VK_STRUCTURE_TYPE_GRAPHICS_PIPELINE_CREATE_INFO,
                                          .pNext = &rendering,
                                          .stageCount = static_cast<uint32_t>(stages.size()),
                                          .pStages = stages.data(),
                                          .pVertexInputState = &input_info,
                                          .pInputAssemblyState = &assembly,
                                          .pViewportState = &viewport,
                                          .pRasterizationState = &raster,
                                          .pMultisampleState = &samples,
                                          .pDepthStencilState = &depth,
                                          .pColorBlendState = &blend,
                                          .pDynamicState = &dynamic,
                                          .layout = pipeline.layout};
  VkPipeline handle = VK_NULL_HANDLE;
  check(device->vkCreateGraphicsPipelines(device.handle, VK_NULL_HANDLE, 1, &info, nullptr, &handle),
        "vkCreateGraphicsPipelines");
  pipeline.handle = Owned<VkPipeline>{device.handle, handle, device->vkDestroyPipeline};
  return pipeline;
}

namespace {

// Resources are mostly named in the order of the bindings, so the one at `place` is tried first.
const Binding& binding_for(const Pipeline& pipeline, const Resource& resource, size_t place) {
  const auto& all = pipeline.bindings;
  const auto is_it = [&](const Binding& binding) { return binding.name == resource.name; };
  const auto found = place < all.size() && is_it(all[place]) ? all.begin() + static_cast<ptrdiff_t>(place)
                                                             : std::find_if(all.begin(), all.end(), is_it);
  const auto fail = [&](const char* what) {
    throw Error(std::string(pipeline.name) + ": " + std::string(resource.name) + ": " + what);
  };
  if (found == all.end()) fail("there is no such binding");
  if (found->type != resource.bound.type) fail("what is bound is of another type");
  return *found;
}

}  // namespace

void bind(Commands cmd, const Pipeline& pipeline, std::span<const Resource> resources) {
  std::array<VkWriteDescriptorSet, most_bindings> writes;
  uint32_t count = 0;
  uint32_t bound = 0;  // a bit for each binding's number
  for (const Resource& resource : resources) {
    const Binding& binding = binding_for(pipeline, resource, count);
    bound |= 1u << binding.number;
    writes.at(count) = {.sType = VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET,
                        .dstBinding = binding.number,
                        .descriptorCount = 1,
                        .descriptorType = binding.type,
                        .pImageInfo = &resource.bound.image,
                        .pBufferInfo = &resource.bound.buffer};
    ++count;
  }
  for (const Binding& binding : pipeline.bindings)
    if (binding.is_used && (bound >> binding.number & 1u) == 0)
      throw Error(std::string(pipeline.name) + ": " + std::string(binding.name) + ": nothing is bound");
  cmd->vkCmdBindPipeline(cmd, pipeline.bind_point, pipeline.handle);
  cmd->vkCmdPushDescriptorSetKHR(cmd, pipeline.bind_point, pipeline.layout, 0, count, writes.data());
}

void push_bytes(Commands cmd, const Pipeline& pipeline, std::span<const std::byte> bytes) {
  if (bytes.size() != pipeline.push_bytes)
    throw Error(std::string(pipeline.name) + ": takes " + std::to_string(pipeline.push_bytes) +
                " bytes of push constants (" + std::to_string(bytes.size()) + ")");
  cmd->vkCmdPushConstants(cmd, pipeline.layout, VK_SHADER_STAGE_ALL, 0, static_cast<uint32_t>(bytes.size()),
                          bytes.data());
}

void dispatch(Commands cmd, const Device& device, const Pipeline& pipeline, uint64_t threads) {
  const uint64_t group = pipeline.local_size[0];
  const uint64_t groups = (threads + group - 1) / group;
  if (groups == 0) return;
  const uint64_t x = std::min<uint64_t>(groups, device.limits.maxComputeWorkGroupCount[0]);
  const uint64_t y = (groups + x - 1) / x;
  if (y > device.limits.maxComputeWorkGroupCount[1]) throw Error("a dispatch is too large for this device");
  cmd->vkCmdDispatch(cmd, static_cast<uint32_t>(x), static_cast<uint32_t>(y), 1);
}

void dispatch_over(Commands cmd, const Pipeline& pipeline, uint32_t width, uint32_t height) {
  const auto [x, y, z] = pipeline.local_size;
  cmd->vkCmdDispatch(cmd, (width + x - 1) / x, (height + y - 1) / y, 1);
}

void set_viewport(Commands cmd, uint32_t width, uint32_t height) {
  const VkViewport viewport{0.0f, 0.0f, static_cast<float>(width), static_cast<float>(height), 0.0f, 1.0f};
  const VkRect2D scissor{{0, 0}, {width, height}};
  cmd->vkCmdSetViewport(cmd, 0, 1, &viewport);
  cmd->vkCmdSetScissor(cmd, 0, 1, &scissor);
}

}  // namespace chandelier::gpu
