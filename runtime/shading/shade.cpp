// SPDX-License-Identifier: Apache-2.0
#include "shading/shade.h"

#include <volk.h>

#include <algorithm>

#include "frame_schema.h"
#include "shaders/shade_comp.h"
#include "shaders/shade_edges_comp.h"
#include "shaders/visibility_comp.h"

namespace chandelier {
namespace {

enum class Shader : uint32_t { visibility, shade, shade_edges };

const gpu::Shader& code_of(Shader shader) {
  if (shader == Shader::visibility) return visibility_comp;
  return shader == Shader::shade ? shade_comp : shade_edges_comp;
}

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

// Made when first needed: few of the combinations are ever drawn with.
const gpu::Pipeline& pipeline_for(const gpu::Device& device, ShadePipelines& pipelines, Shader shader,
                                  const Recipe& recipe, const ShadeInput& input, uint32_t samples) {
  const auto number = [](auto answer) { return static_cast<uint32_t>(answer); };
  const std::array<uint32_t, 8> key{
      number(shader),         number(recipe.filter), number(recipe.shade),  number(recipe.lookup),
      number(recipe.deliver), input.projections,     input.parts_of_layers, samples};
  const auto found = pipelines.made.find(key);
  if (found != pipelines.made.end()) return found->second;
  gpu::Constants constants{{"filter_answer", number(recipe.filter)},
                           {"lookup_answer", number(recipe.lookup)},
                           {"projections", input.projections},
                           {"parts_of_layers", input.parts_of_layers}};
  if (shader != Shader::visibility) constants.push_back({"shade_answer", number(recipe.shade)});
  if (shader == Shader::shade) constants.push_back({"deliver_answer", number(recipe.deliver)});
  if (shader == Shader::shade_edges) constants.push_back({"samples", samples});
  return pipelines.made.emplace(key, gpu::make_compute_pipeline(device, code_of(shader), constants)).first->second;
}

void record_over_picture(gpu::Commands cmd, const gpu::Device& device, ShadePipelines& pipelines, Shader shader,
                         const Recipe& recipe, const ShadeInput& input, const CubeArray& store,
                         const Targets& targets) {
  const gpu::Pipeline& pipeline = pipeline_for(device, pipelines, shader, recipe, input, 1);
  // Every binding has to be something, read or not.
  const gpu::Buffer& tile_words = input.lookup.words ? *input.lookup.words : input.lights;
  const gpu::Buffer& visibility = recipe.deliver == Deliver::textures ? input.visibility : input.lights;
  gpu::bind(cmd, pipeline,
            {{"View", gpu::storage(input.view)},
             {"Lights", gpu::storage(input.lights)},
             {"Maps", gpu::storage(input.maps)},
             {"Views", gpu::storage(input.views)},
             {"surface_image", gpu::sampled(targets.surface.view, pipelines.texel_sampler)},
             {"depth_image", gpu::sampled(targets.depth.view, pipelines.texel_sampler)},
             {"cubes", gpu::sampled(store.cubes, pipelines.linear_compare)},
             {"layers", gpu::sampled(store.depth.view, pipelines.linear_compare)},
             {"radiance_image", gpu::storage_image(targets.radiance)},
             {"TileWords", gpu::storage(tile_words)},
             {"Visibility", gpu::storage(visibility)},
             {"cube_depths", gpu::sampled(store.cubes, pipelines.nearest_depth)},
             {"layer_depths", gpu::sampled(store.depth.view, pipelines.nearest_depth)}});
  gpu::push_constants(cmd, pipeline,
                      frame::ShadeConstants{.first_light = input.first_light,
                                            .light_end = input.first_light + input.light_count,
                                            .tiles_x = input.lookup.tiles_x,
                                            .words_per_tile = input.lookup.words_per_tile});
  gpu::dispatch_over(cmd, pipeline, targets.width, targets.height);
}

}  // namespace

uint32_t projections_of(std::span<const frame::ShadowMap> maps) {
  uint32_t projections = 0;
  for (const frame::ShadowMap& map : maps) projections |= 1u << static_cast<uint32_t>(map.projection);
  return projections ? projections : 1u;  // one variant less
}

ShadePipelines make_shade_pipelines(const gpu::Device& device) {
  ShadePipelines pipelines;
  pipelines.texel_sampler = gpu::make_texel_sampler(device);
  pipelines.linear_compare = shadow_sampler(device, VK_FILTER_LINEAR, VK_TRUE);
  pipelines.nearest_depth = shadow_sampler(device, VK_FILTER_NEAREST, VK_FALSE);
  return pipelines;
}

void record_visibility(gpu::Commands cmd, const gpu::Device& device, ShadePipelines& pipelines, const Recipe& recipe,
                       const ShadeInput& input, const CubeArray& store, const Targets& targets) {
  gpu::memory_barrier(cmd, VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT, VK_ACCESS_2_NONE,
                      VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT, VK_ACCESS_2_NONE);
  record_over_picture(cmd, device, pipelines, Shader::visibility, recipe, input, store, targets);
  gpu::memory_barrier(cmd, VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT, VK_ACCESS_2_SHADER_STORAGE_WRITE_BIT,
                      VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT, VK_ACCESS_2_SHADER_STORAGE_READ_BIT);
}

void record_shade(gpu::Commands cmd, const gpu::Device& device, ShadePipelines& pipelines, const Recipe& recipe,
                  const ShadeInput& input, const CubeArray& store, const Targets& targets) {
  gpu::image_barrier(cmd, targets.radiance, use::storage, use::storage);
  record_over_picture(cmd, device, pipelines, Shader::shade, recipe, input, store, targets);
}

void record_shade_edges(gpu::Commands cmd, const gpu::Device& device, ShadePipelines& pipelines, const Recipe& recipe,
                        const ShadeInput& input, const CubeArray& store, const Edges& edges, const EdgeRange& range) {
  const Targets& targets = edges.targets;
  const gpu::Pipeline& pipeline = pipeline_for(device, pipelines, Shader::shade_edges, recipe, input, targets.samples);
  gpu::memory_barrier(cmd, VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT, VK_ACCESS_2_SHADER_STORAGE_WRITE_BIT,
                      VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT,
                      VK_ACCESS_2_SHADER_STORAGE_READ_BIT | VK_ACCESS_2_SHADER_STORAGE_WRITE_BIT);
  gpu::bind(cmd, pipeline,
            {{"View", gpu::storage(input.view)},
             {"Lights", gpu::storage(input.lights)},
             {"Maps", gpu::storage(input.maps)},
             {"Views", gpu::storage(input.views)},
             {"surface_image", gpu::sampled(targets.surface.view, pipelines.texel_sampler)},
             {"depth_image", gpu::sampled(targets.depth.view, pipelines.texel_sampler)},
             {"cubes", gpu::sampled(store.cubes, pipelines.linear_compare)},
             {"layers", gpu::sampled(store.depth.view, pipelines.linear_compare)},
             {"radiance_image", gpu::storage_image(targets.radiance)},
             {"TileWords", gpu::storage(input.lookup.words ? *input.lookup.words : input.lights)},
             {"Visibility", gpu::storage(recipe.filter == Filter::rays ? input.visibility : input.lights)},
             {"cube_depths", gpu::sampled(store.cubes, pipelines.nearest_depth)},
             {"layer_depths", gpu::sampled(store.depth.view, pipelines.nearest_depth)},
             {"surface_samples", gpu::sampled(targets.of_samples.surface.view, pipelines.texel_sampler)},
             {"depth_samples", gpu::sampled(targets.of_samples.depth.view, pipelines.texel_sampler)},
             {"EdgeSurfaces", gpu::storage(edges.lists.surfaces)},
             {"EdgeGroups", gpu::storage(edges.lists.groups)},
             {"Counters", gpu::storage(edges.lists.counters)}});
  gpu::push_constants(cmd, pipeline,
                      frame::ShadeConstants{.first_light = input.first_light,
                                            .light_end = input.first_light + input.light_count,
                                            .tiles_x = edges.lists.tiles_x,
                                            .words_per_tile = input.lookup.words_per_tile,
                                            .first_edge = range.first,
                                            .edge_count = range.count});
  dispatch_edge_groups(cmd, edges.lists);
}

}  // namespace chandelier
