// SPDX-License-Identifier: Apache-2.0
// Pixels whose samples show several surfaces: found after the g-buffer, each of their surfaces listed and shaded apart,
// and mixed at the end.
#pragma once

#include "frame_schema.h"
#include "gpu/pipelines.h"
#include "shading/targets.h"

namespace chandelier {

/// For one number of samples.
struct EdgePipelines {
  gpu::Pipeline find;
  gpu::Pipeline collect;
  gpu::Pipeline points;
  gpu::Pipeline resolve_radiance;
  gpu::Pipeline resolve_shown;
  gpu::Owned<VkSampler> texel_sampler;
};
EdgePipelines make_edge_pipelines(const gpu::Device& device, uint32_t samples);

/// Room for as many surfaces as the picture has samples: no edge can be left out. Empty where pixels have one sample.
struct EdgeLists {
  gpu::Buffer tiles;         // frame EdgeTile: one for each tile
  gpu::Buffer tile_numbers;  // of tiles with edges
  gpu::Buffer surfaces;      // frame EdgeSurface
  gpu::Buffer groups;        // frame EdgeGroup
  gpu::Buffer counters;      // frame EdgeCounters
  uint32_t tiles_x = 0;
  uint64_t size_bytes = 0;
};
/// Can the device bind the lists of such a picture?
bool has_room_for_edges(const gpu::Device& device, uint32_t width, uint32_t height, uint32_t samples);
/// Throws gpu::Error where it cannot.
EdgeLists make_edge_lists(const gpu::Device& device, uint32_t width, uint32_t height, uint32_t samples);

/// Edges as the passes below take them.
struct Edges {
  const EdgePipelines& pipelines;
  const EdgeLists& lists;
  const Targets& targets;
  float pixel_angle;  // width of a pixel in the middle of the picture, for each metre of distance
};

/// A dispatch of one work group for each frame EdgeGroup.
void dispatch_edge_groups(gpu::Commands cmd, const EdgeLists& lists);

/// Splits what the g-buffer drew: pixels with one surface into the targets, as record_g_buffer() leaves them with one
/// sample; the others' surfaces into the lists.
void record_find_edges(gpu::Commands cmd, const Edges& edges);
/// Writes edge pixels' radiance, after all light has been added.
void record_resolve(gpu::Commands cmd, const Edges& edges);
/// Writes what edge pixels show, after record_tone_map(), and leaves `shown` as that does.
void record_resolve_shown(gpu::Commands cmd, const Edges& edges, const gpu::Buffer& luminance_sums);
/// Writes a frame EdgePoint for each surface into `points`.
void record_edge_points(gpu::Commands cmd, const Edges& edges, const gpu::Buffer& view, const gpu::Buffer& points);

}  // namespace chandelier
