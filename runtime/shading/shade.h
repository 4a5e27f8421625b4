// SPDX-License-Identifier: Apache-2.0
// The shade stage of one group: adds the light of its lights.
#pragma once

#include "shading/edges.h"
#include "shading/group_pass.h"

namespace chandelier {

/// Of the surfaces of edge pixels, those that are shaded. Filter rays: `visibility` has a byte for each map and each of
/// them.
struct EdgeRange {
  uint32_t first = 0;
  uint32_t count = 0;
};
void record_shade(gpu::Commands cmd, const gpu::Device& device, GroupPipelines& pipelines, const Recipe& recipe,
                  const GroupInput& input, const CubeArray& store, const Targets& targets);
/// The same for the surfaces of edge pixels; the range counts with filter rays alone.
void record_shade_edges(gpu::Commands cmd, const gpu::Device& device, GroupPipelines& pipelines, const Recipe& recipe,
                        const GroupInput& input, const CubeArray& store, const Edges& edges,
                        const EdgeRange& range = {});

}  // namespace chandelier
