// SPDX-License-Identifier: Apache-2.0
// The shade stage: adds the light of one round, filtered visibility included.
#pragma once

#include "frame/recipe.h"
#include "frame/targets.h"
#include "gpu/pipelines.h"
#include "shadows/store/cube_array.h"

namespace chandelier {

struct ShadePipelines {
  std::vector<gpu::Pipeline> by_filter_and_shade;  // filter * 2 + shade
  gpu::Owned<VkSampler> texel_sampler;             // for targets
  gpu::Owned<VkSampler> nearest_compare;           // filter hard
  gpu::Owned<VkSampler> linear_compare;            // other filters
};
ShadePipelines make_shade_pipelines(const gpu::Device& device);

struct ShadeInput {
  const gpu::Buffer& view;    // frame ViewConstants
  const gpu::Buffer& lights;  // frame FrameLight
  const gpu::Buffer& maps;    // frame ShadowMap
  const gpu::Buffer& views;   // frame ShadowView
  uint32_t first_map;
  uint32_t map_count;
};
void record_shade(VkCommandBuffer cmd, const ShadePipelines& pipelines, const Recipe& recipe, const ShadeInput& input,
                  const CubeArray& store, const Targets& targets);

}  // namespace chandelier
