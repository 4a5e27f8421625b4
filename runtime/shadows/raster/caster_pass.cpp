// SPDX-License-Identifier: Apache-2.0
#include "shadows/raster/caster_pass.h"

#include <volk.h>

#include <algorithm>

#include "gpu/image_uses.h"
#include "shaders/caster_masked_frag.h"
#include "shaders/caster_masked_placed_vert.h"
#include "shaders/caster_masked_vert.h"
#include "shaders/caster_placed_vert.h"
#include "shaders/caster_vert.h"

namespace chandelier {
namespace {

// The squares of the maps that are drawn.
void clear_maps(gpu::Commands cmd, const CasterInput& input) {
  std::vector<VkClearRect> squares;
  for (const frame::ShadowMap& map : input.maps)
    if (map.is_kept == 0)
      squares.push_back(
          {{{static_cast<int32_t>(map.left_px), static_cast<int32_t>(map.top_px)}, {map.size_px, map.size_px}},
           6 * map.cube,
           6});
  constexpr VkClearAttachment far{.aspectMask = VK_IMAGE_ASPECT_DEPTH_BIT, .clearValue = {.depthStencil = {0.0f, 0}}};
  if (!squares.empty()) cmd->vkCmdClearAttachments(cmd, 1, &far, static_cast<uint32_t>(squares.size()), squares.data());
}

void begin_pass(gpu::Commands cmd, const CasterInput& input, bool clear) {
  const CubeArray& store = input.store;
  const VkRenderingAttachmentInfo depth{
      .sType = VK_STRUCTURE_TYPE_RENDERING_ATTACHMENT_INFO,
      .imageView = store.depth.view,
      .imageLayout = VK_IMAGE_LAYOUT_DEPTH_ATTACHMENT_OPTIMAL,
      .loadOp = clear && !input.keeps ? VK_ATTACHMENT_LOAD_OP_CLEAR : VK_ATTACHMENT_LOAD_OP_LOAD,
      .storeOp = VK_ATTACHMENT_STORE_OP_STORE,
      .clearValue = {.depthStencil = {0.0f, 0}}};
  const VkRenderingInfo info{.sType = VK_STRUCTURE_TYPE_RENDERING_INFO,
                             .renderArea = {{0, 0}, {store.layer_size_px, store.layer_size_px}},
                             .layerCount = 6 * (input.keeps ? store.cube_count : input.cube_count),
                             .pDepthAttachment = &depth};
  cmd->vkCmdBeginRendering(cmd, &info);
  if (clear && input.keeps) clear_maps(cmd, input);
  gpu::set_viewport(cmd, store.layer_size_px, store.layer_size_px);
  // Both sides of a surface cast: an open mesh shadows whichever way it faces.
  cmd->vkCmdSetCullMode(cmd, VK_CULL_MODE_NONE);
}

// The vertices and indices that the draws of a list take.
void bind_stream(gpu::Commands cmd, const GpuScene& scene, GeometryStream stream) {
  switch (stream) {
    case GeometryStream::batches: {
      const VkBuffer buffers[]{scene.positions.handle, scene.vertex_attributes.handle};
      const VkDeviceSize offsets[]{0, 0};
      cmd->vkCmdBindVertexBuffers(cmd, 0, 2, buffers, offsets);
      cmd->vkCmdBindIndexBuffer(cmd, scene.indices.handle, 0, VK_INDEX_TYPE_UINT32);
      return;
    }
  }
}

void bind_casters(gpu::Commands cmd, const gpu::Pipeline& pipeline, const GpuScene& scene, const CasterInput& input,
                  bool opaque) {
  const gpu::Resource views{"Views", gpu::storage(input.views)};
  const gpu::Resource draws{"Draws", gpu::storage(input.culled.draws)};
  const gpu::Resource instances{"Instances", gpu::storage(scene.instances)};
  if (opaque)
    gpu::bind(cmd, pipeline, {views, draws, instances});
  else
    gpu::bind(cmd, pipeline,
              {views,
               draws,
               instances,
               {"Materials", gpu::storage(scene.materials)},
               {"UvTransforms", gpu::storage(scene.uv_transforms)}});
  if (pipeline.push_bytes > 0)
    gpu::push_constants(cmd, pipeline, frame::CasterConstants{.layer_size_px = input.store.layer_size_px});
}

}  // namespace

CasterPipelines make_caster_pipelines(const gpu::Device& device, const GpuScene& scene) {
  const auto opaque = [&](const gpu::Shader& vertex) {
    return gpu::make_graphics_pipeline(device,
                                       {.vertex = vertex, .streams = position_stream(), .depth = VK_FORMAT_D32_SFLOAT});
  };
  const auto masked = [&](const gpu::Shader& vertex) {
    return gpu::make_graphics_pipeline(device, {.vertex = vertex,
                                                .fragment = &caster_masked_frag,
                                                .more_sets = {scene.material_layout},
                                                .streams = position_and_attribute_streams(),
                                                .depth = VK_FORMAT_D32_SFLOAT});
  };
  return {opaque(caster_vert), masked(caster_masked_vert), opaque(caster_placed_vert),
          masked(caster_masked_placed_vert)};
}

void begin_casters(gpu::Commands cmd, const CasterInput& input) {
  gpu::image_barrier(cmd, input.store.depth, input.keeps ? use::sampled : use::nothing, use::depth_attachment);
}

void end_casters(gpu::Commands cmd, const CasterInput& input) {
  gpu::image_barrier(cmd, input.store.depth, use::depth_attachment, use::sampled);
}

void record_casters(gpu::Commands cmd, const CasterPipelines& pipelines, const GpuScene& scene,
                    const CasterInput& input, uint32_t pass) {
  if (pass > 0) gpu::image_barrier(cmd, input.store.depth, use::depth_attachment, use::depth_attachment);
  begin_pass(cmd, input, pass == 0);
  const bool placed = has_parts_of_layers(input.maps, input.store);
  const gpu::Pipeline& opaque = placed ? pipelines.opaque_placed : pipelines.opaque;
  const gpu::Pipeline& masked = placed ? pipelines.masked_placed : pipelines.masked;
  const gpu::Pipeline* bound = nullptr;
  std::optional<GeometryStream> stream;
  for (size_t i = 0; i < input.culled.lists.size(); ++i) {
    const DrawList& list = input.culled.lists[i];
    const bool is_opaque = list.material == pack::none;
    const gpu::Pipeline& pipeline = is_opaque ? opaque : masked;
    if (stream != list.stream) bind_stream(cmd, scene, list.stream);
    if (&pipeline != bound) bind_casters(cmd, pipeline, scene, input, is_opaque);
    stream = list.stream;
    bound = &pipeline;
    if (!is_opaque)
      cmd->vkCmdBindDescriptorSets(cmd, VK_PIPELINE_BIND_POINT_GRAPHICS, pipeline.layout, 1, 1,
                                   &scene.material_sets[list.material], 0, nullptr);
    draw_list(cmd, input.culled, i, pass);
  }
  cmd->vkCmdEndRendering(cmd);
}

}  // namespace chandelier
