// SPDX-License-Identifier: Apache-2.0
#include "shading/edges.h"

#include <volk.h>

#include <cstddef>

#include "shaders/collect_edges_comp.h"
#include "shaders/edge_points_comp.h"
#include "shaders/find_edges_comp.h"
#include "shaders/resolve_radiance_comp.h"
#include "shaders/resolve_shown_comp.h"

namespace chandelier {
namespace {

// In the middle of a pixel, triangles of one surface may lie as far apart as this many pixels are wide.
constexpr float same_depth_px = 4.0f;

void computed_before_compute(gpu::Commands cmd) {
  gpu::memory_barrier(cmd, VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT, VK_ACCESS_2_SHADER_STORAGE_WRITE_BIT,
                      VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT | VK_PIPELINE_STAGE_2_DRAW_INDIRECT_BIT,
                      VK_ACCESS_2_SHADER_STORAGE_READ_BIT | VK_ACCESS_2_SHADER_STORAGE_WRITE_BIT |
                          VK_ACCESS_2_INDIRECT_COMMAND_READ_BIT);
}

void push(gpu::Commands cmd, const gpu::Pipeline& pipeline, const Edges& edges) {
  gpu::push_constants(
      cmd, pipeline,
      frame::EdgeConstants{.tiles_x = edges.lists.tiles_x, .same_depth = same_depth_px * edges.pixel_angle});
}

void clear_counters(gpu::Commands cmd, const EdgeLists& lists) {
  constexpr frame::EdgeCounters none{.tiles_z = 1, .groups_z = 1};
  cmd->vkCmdUpdateBuffer(cmd, lists.counters.handle, 0, sizeof none, &none);
  gpu::memory_barrier(cmd, VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT, VK_ACCESS_2_TRANSFER_WRITE_BIT,
                      VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT,
                      VK_ACCESS_2_SHADER_STORAGE_READ_BIT | VK_ACCESS_2_SHADER_STORAGE_WRITE_BIT);
}

void record_find(gpu::Commands cmd, const Edges& edges) {
  const auto& [pipelines, lists, targets, pixel_angle] = edges;
  for (const gpu::Image* image : {&targets.surface, &targets.depth, &targets.radiance})
    gpu::image_barrier(cmd, *image, use::nothing, use::storage);
  gpu::bind(cmd, pipelines.find,
            {{"surface_samples", gpu::sampled(targets.of_samples.surface.view, pipelines.texel_sampler)},
             {"radiance_samples", gpu::sampled(targets.of_samples.radiance.view, pipelines.texel_sampler)},
             {"middle_depth_samples", gpu::sampled(targets.of_samples.middle_depth.view, pipelines.texel_sampler)},
             {"surface_image", gpu::storage_image(targets.surface)},
             {"depth_image", gpu::storage_image(targets.depth)},
             {"radiance_image", gpu::storage_image(targets.radiance)},
             {"EdgeTiles", gpu::storage(lists.tiles)},
             {"EdgeTileNumbers", gpu::storage(lists.tile_numbers)},
             {"Counters", gpu::storage(lists.counters)}});
  push(cmd, pipelines.find, edges);
  gpu::dispatch_over(cmd, pipelines.find, targets.width, targets.height);
  gpu::image_barrier(cmd, targets.surface, use::storage, use::sampled);
  gpu::image_barrier(cmd, targets.depth, use::storage, use::sampled);
}

void record_collect(gpu::Commands cmd, const Edges& edges) {
  const auto& [pipelines, lists, targets, pixel_angle] = edges;
  gpu::bind(cmd, pipelines.collect,
            {{"surface_samples", gpu::sampled(targets.of_samples.surface.view, pipelines.texel_sampler)},
             {"radiance_samples", gpu::sampled(targets.of_samples.radiance.view, pipelines.texel_sampler)},
             {"middle_depth_samples", gpu::sampled(targets.of_samples.middle_depth.view, pipelines.texel_sampler)},
             {"depth_samples", gpu::sampled(targets.of_samples.depth.view, pipelines.texel_sampler)},
             {"EdgeTiles", gpu::storage(lists.tiles)},
             {"EdgeTileNumbers", gpu::storage(lists.tile_numbers)},
             {"Counters", gpu::storage(lists.counters)},
             {"EdgeSurfaces", gpu::storage(lists.surfaces)},
             {"EdgeGroups", gpu::storage(lists.groups)}});
  push(cmd, pipelines.collect, edges);
  cmd->vkCmdDispatchIndirect(cmd, lists.counters.handle, offsetof(frame::EdgeCounters, tiles_x));
}

}  // namespace

EdgePipelines make_edge_pipelines(const gpu::Device& device, uint32_t samples) {
  return {gpu::make_compute_pipeline(device, find_edges_comp, {{"samples", samples}}),
          gpu::make_compute_pipeline(device, collect_edges_comp, {{"samples", samples}}),
          gpu::make_compute_pipeline(device, edge_points_comp, {{"samples", samples}}),
          gpu::make_compute_pipeline(device, resolve_radiance_comp, {{"samples", samples}}),
          gpu::make_compute_pipeline(device, resolve_shown_comp, {{"samples", samples}}),
          gpu::make_texel_sampler(device)};
}

bool has_room_for_edges(const gpu::Device& device, uint32_t width, uint32_t height, uint32_t samples) {
  return uint64_t{width} * height * samples * sizeof(frame::EdgeSurface) <= device.limits.maxStorageBufferRange;
}

EdgeLists make_edge_lists(const gpu::Device& device, uint32_t width, uint32_t height, uint32_t samples) {
  EdgeLists lists;
  if (samples == 1) return lists;
  constexpr uint64_t tile_pixels = uint64_t{frame::tile_size_px} * frame::tile_size_px;
  constexpr uint64_t turns =
      tile_pixels / frame::edge_group_size;  // collect_edges.comp: each fills up to `samples` groups
  lists.tiles_x = (width + frame::tile_size_px - 1) / frame::tile_size_px;
  const uint64_t tiles = uint64_t{lists.tiles_x} * ((height + frame::tile_size_px - 1) / frame::tile_size_px);
  const auto buffer = [&](uint64_t records, size_t record_bytes, VkBufferUsageFlags usage = 0) {
    const uint64_t bytes = records * record_bytes;
    if (bytes > device.limits.maxStorageBufferRange)
      throw gpu::Error("a picture of " + std::to_string(width) + " x " + std::to_string(height) + " pixels with " +
                       std::to_string(samples) + " samples each is too large for this device; use fewer samples");
    lists.size_bytes += bytes;
    return gpu::make_buffer(device, bytes, VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | usage, gpu::Memory::device);
  };
  lists.tiles = buffer(tiles, sizeof(frame::EdgeTile));
  lists.tile_numbers = buffer(tiles, sizeof(uint32_t));
  lists.surfaces = buffer(uint64_t{width} * height * samples, sizeof(frame::EdgeSurface));
  lists.groups = buffer(tiles * turns * samples, sizeof(frame::EdgeGroup));
  lists.counters =
      buffer(1, sizeof(frame::EdgeCounters),
             VK_BUFFER_USAGE_INDIRECT_BUFFER_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT | VK_BUFFER_USAGE_TRANSFER_SRC_BIT);
  return lists;
}

void dispatch_edge_groups(gpu::Commands cmd, const EdgeLists& lists) {
  cmd->vkCmdDispatchIndirect(cmd, lists.counters.handle, offsetof(frame::EdgeCounters, groups_x));
}

void record_find_edges(gpu::Commands cmd, const Edges& edges) {
  clear_counters(cmd, edges.lists);
  record_find(cmd, edges);
  computed_before_compute(cmd);
  record_collect(cmd, edges);
  computed_before_compute(cmd);
}

void record_resolve(gpu::Commands cmd, const Edges& edges) {
  const gpu::Pipeline& pipeline = edges.pipelines.resolve_radiance;
  gpu::image_barrier(cmd, edges.targets.radiance, use::storage, use::storage);
  computed_before_compute(cmd);
  gpu::bind(cmd, pipeline,
            {{"EdgeSurfaces", gpu::storage(edges.lists.surfaces)},
             {"EdgeGroups", gpu::storage(edges.lists.groups)},
             {"Counters", gpu::storage(edges.lists.counters)},
             {"radiance_image", gpu::storage_image(edges.targets.radiance)}});
  push(cmd, pipeline, edges);
  dispatch_edge_groups(cmd, edges.lists);
}

void record_resolve_shown(gpu::Commands cmd, const Edges& edges, const gpu::Buffer& luminance_sums) {
  const gpu::Pipeline& pipeline = edges.pipelines.resolve_shown;
  gpu::image_barrier(cmd, edges.targets.shown, use::copied, use::storage);
  gpu::bind(cmd, pipeline,
            {{"EdgeSurfaces", gpu::storage(edges.lists.surfaces)},
             {"EdgeGroups", gpu::storage(edges.lists.groups)},
             {"Counters", gpu::storage(edges.lists.counters)},
             {"Sums", gpu::storage(luminance_sums)},
             {"shown_image", gpu::storage_image(edges.targets.shown)}});
  push(cmd, pipeline, edges);
  dispatch_edge_groups(cmd, edges.lists);
  gpu::image_barrier(cmd, edges.targets.shown, use::storage, use::copied);
}

void record_edge_points(gpu::Commands cmd, const Edges& edges, const gpu::Buffer& view, const gpu::Buffer& points) {
  const auto& [pipelines, lists, targets, pixel_angle] = edges;
  gpu::bind(cmd, pipelines.points,
            {{"View", gpu::storage(view)},
             {"surface_samples", gpu::sampled(targets.of_samples.surface.view, pipelines.texel_sampler)},
             {"depth_samples", gpu::sampled(targets.of_samples.depth.view, pipelines.texel_sampler)},
             {"EdgeSurfaces", gpu::storage(lists.surfaces)},
             {"EdgeGroups", gpu::storage(lists.groups)},
             {"Counters", gpu::storage(lists.counters)},
             {"EdgePoints", gpu::storage(points)}});
  push(cmd, pipelines.points, edges);
  dispatch_edge_groups(cmd, lists);
}

}  // namespace chandelier
