// SPDX-License-Identifier: Apache-2.0
#include "shading/group_pass.h"

#include <algorithm>

namespace chandelier {
namespace {

// Outside a cascade nothing casts: the border is as far as depth goes.
gpu::Owned<VkSampler> shadow_sampler(const gpu::Device& device, VkFilter filter, VkBool32 compare) {
  return gpu::make_sampler(device, {.sType = VK_STRUCTURE_TYPE_SAMPLER_CREATE_INFO,
                                    .magFilter = filter,
                                    .minFilter = filter,
                                    .addressModeU = VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_BORDER,
                                    .addressModeV = VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_BORDER,
                                    .addressModeW = VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE,
                                    .compareEnable = compare,
                                    .compareOp = VK_COMPARE_OP_GREATER_OR_EQUAL,
                                    .borderColor = VK_BORDER_COLOR_FLOAT_TRANSPARENT_BLACK});
}

bool has_constant(const gpu::Shader& shader, std::string_view name) {
  return std::ranges::find(shader.constants, name, &gpu::Named::name) != shader.constants.end();
}

}  // namespace

GroupPipelines::GroupPipelines(const gpu::Device& device)
    : texel_sampler(gpu::make_texel_sampler(device)),
      linear_compare(shadow_sampler(device, VK_FILTER_LINEAR, VK_TRUE)),
      nearest_depth(shadow_sampler(device, VK_FILTER_NEAREST, VK_FALSE)) {}

uint32_t projections_of(std::span<const frame::ShadowMap> maps) {
  uint32_t projections = 0;
  for (const frame::ShadowMap& map : maps) projections |= 1u << static_cast<uint32_t>(map.projection);
  return projections ? projections : 1u;  // one variant less
}

const gpu::Pipeline& group_pipeline(const gpu::Device& device, GroupPipelines& pipelines, const gpu::Shader& shader,
                                    const Recipe& recipe, const GroupInput& input, uint32_t samples) {
  const auto number = [](auto answer) { return static_cast<uint32_t>(answer); };
  const std::array<uint64_t, 8> key{reinterpret_cast<uint64_t>(shader.words.data()),
                                    number(recipe.filter),
                                    number(recipe.shade),
                                    number(recipe.lookup),
                                    number(recipe.deliver),
                                    input.projections,
                                    input.parts_of_layers,
                                    samples};
  const auto found = pipelines.made.find(key);
  if (found != pipelines.made.end()) return found->second;
  gpu::Constants constants{{"filter_answer", number(recipe.filter)},
                           {"lookup_answer", number(recipe.lookup)},
                           {"shade_answer", number(recipe.shade)},
                           {"deliver_answer", number(recipe.deliver)},
                           {"projections", input.projections},
                           {"parts_of_layers", input.parts_of_layers},
                           {"samples", samples}};
  std::erase_if(constants, [&](const gpu::Constant& constant) { return !has_constant(shader, constant.name); });
  return pipelines.made.emplace(key, gpu::make_compute_pipeline(device, shader, constants)).first->second;
}

std::array<gpu::Resource, 13> group_resources(const GroupPipelines& pipelines, const GroupInput& input,
                                              const gpu::Buffer& visibility, const CubeArray& store,
                                              const Targets& targets) {
  return {{{"View", gpu::storage(input.view)},
           {"Lights", gpu::storage(input.lights)},
           {"Maps", gpu::storage(input.maps)},
           {"Views", gpu::storage(input.views)},
           {"surface_image", gpu::sampled(targets.surface.view, pipelines.texel_sampler)},
           {"depth_image", gpu::sampled(targets.depth.view, pipelines.texel_sampler)},
           {"cubes", gpu::sampled(store.cubes, pipelines.linear_compare)},
           {"layers", gpu::sampled(store.depth.view, pipelines.linear_compare)},
           {"radiance_image", gpu::storage_image(targets.radiance)},
           {"TileWords", gpu::storage(input.lookup.words ? *input.lookup.words : input.lights)},
           {"Visibility", gpu::storage(visibility)},
           {"cube_depths", gpu::sampled(store.cubes, pipelines.nearest_depth)},
           {"layer_depths", gpu::sampled(store.depth.view, pipelines.nearest_depth)}}};
}

frame::ShadeConstants group_constants(const GroupInput& input) {
  return {.first_light = input.first_light,
          .light_end = input.first_light + input.light_count,
          .tiles_x = input.lookup.tiles_x,
          .words_per_tile = input.lookup.words_per_tile};
}

}  // namespace chandelier
