// SPDX-License-Identifier: Apache-2.0
// What dispatches over the surfaces of a picture take that read one group's shadow maps (group.glsl).
#pragma once

#include <array>
#include <map>
#include <span>

#include "gpu/pipelines.h"
#include "lookup/lookup.h"
#include "recipe_schema.h"
#include "shading/targets.h"
#include "shadows/store/cube_array.h"

namespace chandelier {

/// Pipelines that were needed once, and the samplers that all of them take.
struct GroupPipelines {
  explicit GroupPipelines(const gpu::Device& device);

  std::map<std::array<uint64_t, 8>, gpu::Pipeline> made;  // by shader and what it is specialized for
  gpu::Owned<VkSampler> texel_sampler;                    // for targets
  gpu::Owned<VkSampler> linear_compare;                   // of depths: filters pcf and pcss
  gpu::Owned<VkSampler> nearest_depth;                    // depths as they are, for all filters
};

/// Which projections shadow maps have, a bit for each.
uint32_t projections_of(std::span<const frame::ShadowMap> maps);

struct GroupInput {
  const gpu::Buffer& view;        // frame ViewConstants
  const gpu::Buffer& lights;      // frame FrameLight
  const gpu::Buffer& maps;        // frame ShadowMap
  const gpu::Buffer& views;       // frame ShadowView
  const gpu::Buffer& visibility;  // bytes of the group's visibility textures; unused where delivery is inline
  LookupData lookup;
  uint32_t first_light;
  uint32_t light_count;
  uint32_t projections;  // of the frame's maps
  bool parts_of_layers;  // a map of the frame has no whole layers
};

/// The shader for the recipe's answers, of which it takes those that it has constants for; `samples` of a pixel.
const gpu::Pipeline& group_pipeline(const gpu::Device& device, GroupPipelines& pipelines, const gpu::Shader& shader,
                                    const Recipe& recipe, const GroupInput& input, uint32_t samples = 1);

/// What group.glsl declares. `visibility`: what its binding takes; it has to be something, read or not.
std::array<gpu::Resource, 13> group_resources(const GroupPipelines& pipelines, const GroupInput& input,
                                              const gpu::Buffer& visibility, const CubeArray& store,
                                              const Targets& targets);

/// Its push constants, for all pixels of a picture.
frame::ShadeConstants group_constants(const GroupInput& input);

}  // namespace chandelier
