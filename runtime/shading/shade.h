// SPDX-License-Identifier: Apache-2.0
// The filter, deliver and shade stages of one group: fills visibility textures where the recipe wants them, and adds
// light.
#pragma once

#include <array>
#include <map>
#include <span>

#include "gpu/pipelines.h"
#include "lookup/lookup.h"
#include "recipe_schema.h"
#include "shading/edges.h"
#include "shading/targets.h"
#include "shadows/store/cube_array.h"

namespace chandelier {

struct ShadePipelines {
  std::map<std::array<uint32_t, 8>, gpu::Pipeline> made;  // by shader and the answers it is specialized for
  gpu::Owned<VkSampler> texel_sampler;                    // for targets
  gpu::Owned<VkSampler> linear_compare;                   // of depths: filters pcf and pcss
  gpu::Owned<VkSampler> nearest_depth;                    // depths as they are, for all filters
};
ShadePipelines make_shade_pipelines(const gpu::Device& device);

/// Which projections shadow maps have, a bit for each.
uint32_t projections_of(std::span<const frame::ShadowMap> maps);

struct ShadeInput {
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
/// Of the surfaces of edge pixels, those that are shaded. Filter rays: `visibility` has a byte for each map and each of
/// them.
struct EdgeRange {
  uint32_t first = 0;
  uint32_t count = 0;
};
/// Filters the group's maps into `input.visibility`, which shading may read afterwards.
void record_visibility(gpu::Commands cmd, const gpu::Device& device, ShadePipelines& pipelines, const Recipe& recipe,
                       const ShadeInput& input, const CubeArray& store, const Targets& targets);
void record_shade(gpu::Commands cmd, const gpu::Device& device, ShadePipelines& pipelines, const Recipe& recipe,
                  const ShadeInput& input, const CubeArray& store, const Targets& targets);
/// The same for the surfaces of edge pixels; the range counts with filter rays alone.
void record_shade_edges(gpu::Commands cmd, const gpu::Device& device, ShadePipelines& pipelines, const Recipe& recipe,
                        const ShadeInput& input, const CubeArray& store, const Edges& edges,
                        const EdgeRange& range = {});

}  // namespace chandelier
