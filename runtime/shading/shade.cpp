// SPDX-License-Identifier: Apache-2.0
#include "shading/shade.h"

#include "frame_schema.h"
#include "shaders/shade_comp.h"

namespace chandelier {
namespace {

constexpr uint32_t shade_answers = 2;
constexpr uint32_t filter_answers = 2;

// Outside a cascade nothing casts: the border is as far as depth goes.
gpu::Owned<VkSampler> compare_sampler(const gpu::Device& device, VkFilter filter) {
  return gpu::make_sampler(device, {.sType = VK_STRUCTURE_TYPE_SAMPLER_CREATE_INFO,
                                    .magFilter = filter,
                                    .minFilter = filter,
                                    .addressModeU = VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_BORDER,
                                    .addressModeV = VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_BORDER,
                                    .addressModeW = VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE,
                                    .compareEnable = VK_TRUE,
                                    .compareOp = VK_COMPARE_OP_GREATER_OR_EQUAL,
                                    .borderColor = VK_BORDER_COLOR_FLOAT_TRANSPARENT_BLACK});
}

}  // namespace

ShadePipelines make_shade_pipelines(const gpu::Device& device) {
  constexpr auto buffer = VK_DESCRIPTOR_TYPE_STORAGE_BUFFER;
  constexpr auto image = VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER;
  const gpu::LayoutInfo layout{
      .bindings = {buffer, buffer, buffer, buffer, image, image, image, image, VK_DESCRIPTOR_TYPE_STORAGE_IMAGE},
      .push_bytes = sizeof(frame::ShadeConstants)};
  ShadePipelines pipelines;
  for (uint32_t filter = 0; filter < filter_answers; ++filter)
    for (uint32_t shade = 0; shade < shade_answers; ++shade)
      pipelines.by_filter_and_shade.push_back(gpu::make_compute_pipeline(device, layout, shade_comp, {filter, shade}));
  pipelines.texel_sampler = gpu::make_sampler(device, {.sType = VK_STRUCTURE_TYPE_SAMPLER_CREATE_INFO,
                                                       .addressModeU = VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE,
                                                       .addressModeV = VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE,
                                                       .addressModeW = VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE});
  pipelines.nearest_compare = compare_sampler(device, VK_FILTER_NEAREST);
  pipelines.linear_compare = compare_sampler(device, VK_FILTER_LINEAR);
  return pipelines;
}

void record_shade(VkCommandBuffer cmd, const ShadePipelines& pipelines, const Recipe& recipe, const ShadeInput& input,
                  const CubeArray& store, const Targets& targets) {
  const auto& pipeline = pipelines.by_filter_and_shade[static_cast<uint32_t>(recipe.filter) * shade_answers +
                                                       static_cast<uint32_t>(recipe.shade)];
  const VkSampler compare = recipe.filter == Filter::hard ? pipelines.nearest_compare : pipelines.linear_compare;
  gpu::image_barrier(cmd, targets.radiance, use::storage, use::storage);
  gpu::bind(cmd, pipeline,
            {gpu::storage(input.view), gpu::storage(input.lights), gpu::storage(input.maps), gpu::storage(input.views),
             gpu::sampled(targets.surface.view, pipelines.texel_sampler),
             gpu::sampled(targets.depth.view, pipelines.texel_sampler), gpu::sampled(store.cubes, compare),
             gpu::sampled(store.depth.view, compare), gpu::storage_image(targets.radiance)});
  gpu::push_constants(cmd, pipeline, frame::ShadeConstants{.first_map = input.first_map, .map_count = input.map_count});
  vkCmdDispatch(cmd, (targets.width + 7) / 8, (targets.height + 7) / 8, 1);
}

}  // namespace chandelier
