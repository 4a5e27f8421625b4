// SPDX-License-Identifier: Apache-2.0
#include "shading/shade.h"

#include <volk.h>

#include <algorithm>

#include "shaders/shade_comp.h"
#include "shaders/shade_edges_comp.h"
#include "shadows/deliver/visibility_textures.h"

namespace chandelier {

void record_shade(gpu::Commands cmd, const gpu::Device& device, GroupPipelines& pipelines, const Recipe& recipe,
                  const GroupInput& input, const CubeArray& store, const Targets& targets) {
  const gpu::Pipeline& pipeline = group_pipeline(device, pipelines, shade_comp, recipe, input);
  const gpu::Buffer& visibility = has_textures(recipe.deliver) ? input.visibility : input.lights;
  gpu::image_barrier(cmd, targets.radiance, use::storage, use::storage);
  gpu::bind(cmd, pipeline, group_resources(pipelines, input, visibility, store, targets));
  gpu::push_constants(cmd, pipeline, group_constants(input));
  gpu::dispatch_over(cmd, pipeline, targets.width, targets.height);
}

void record_shade_edges(gpu::Commands cmd, const gpu::Device& device, GroupPipelines& pipelines, const Recipe& recipe,
                        const GroupInput& input, const CubeArray& store, const Edges& edges, const EdgeRange& range) {
  const Targets& targets = edges.targets;
  const gpu::Pipeline& pipeline = group_pipeline(device, pipelines, shade_edges_comp, recipe, input, targets.samples);
  gpu::memory_barrier(cmd, VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT, VK_ACCESS_2_SHADER_STORAGE_WRITE_BIT,
                      VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT,
                      VK_ACCESS_2_SHADER_STORAGE_READ_BIT | VK_ACCESS_2_SHADER_STORAGE_WRITE_BIT);
  const gpu::Buffer& visibility = recipe.filter == Filter::rays ? input.visibility : input.lights;
  const auto of_group = group_resources(pipelines, input, visibility, store, targets);
  const std::array<gpu::Resource, 5> of_edges{
      {{"surface_samples", gpu::sampled(targets.of_samples.surface.view, pipelines.texel_sampler)},
       {"depth_samples", gpu::sampled(targets.of_samples.depth.view, pipelines.texel_sampler)},
       {"EdgeSurfaces", gpu::storage(edges.lists.surfaces)},
       {"EdgeGroups", gpu::storage(edges.lists.groups)},
       {"Counters", gpu::storage(edges.lists.counters)}}};
  std::array<gpu::Resource, of_group.size() + of_edges.size()> all;
  std::ranges::copy(of_edges, std::ranges::copy(of_group, all.begin()).out);
  gpu::bind(cmd, pipeline, all);
  frame::ShadeConstants constants = group_constants(input);
  constants.tiles_x = edges.lists.tiles_x;
  constants.first_edge = range.first;
  constants.edge_count = range.count;
  gpu::push_constants(cmd, pipeline, constants);
  dispatch_edge_groups(cmd, edges.lists);
}

}  // namespace chandelier
