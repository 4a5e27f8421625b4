// SPDX-License-Identifier: Apache-2.0
#include "shadows/raster/caster_pass.h"

#include <volk.h>

#include "gpu/image_uses.h"
#include "shaders/caster_masked_frag.h"
#include "shaders/caster_masked_vert.h"
#include "shaders/caster_vert.h"

namespace chandelier {
namespace {

void begin_pass(gpu::Commands cmd, const CubeArray& store, uint32_t cubes, bool clear) {
  const VkRenderingAttachmentInfo depth{.sType = VK_STRUCTURE_TYPE_RENDERING_ATTACHMENT_INFO,
                                        .imageView = store.depth.view,
                                        .imageLayout = VK_IMAGE_LAYOUT_DEPTH_ATTACHMENT_OPTIMAL,
                                        .loadOp = clear ? VK_ATTACHMENT_LOAD_OP_CLEAR : VK_ATTACHMENT_LOAD_OP_LOAD,
                                        .storeOp = VK_ATTACHMENT_STORE_OP_STORE,
                                        .clearValue = {.depthStencil = {0.0f, 0}}};
  const VkRenderingInfo info{.sType = VK_STRUCTURE_TYPE_RENDERING_INFO,
                             .renderArea = {{0, 0}, {store.face_size_px, store.face_size_px}},
                             .layerCount = 6 * cubes,
                             .pDepthAttachment = &depth};
  cmd->vkCmdBeginRendering(cmd, &info);
  gpu::set_viewport(cmd, store.face_size_px, store.face_size_px);
  // Both sides of a surface cast: an open mesh shadows whichever way it faces.
  cmd->vkCmdSetCullMode(cmd, VK_CULL_MODE_NONE);
}

}  // namespace

CasterPipelines make_caster_pipelines(const gpu::Device& device, const GpuScene& scene) {
  return {gpu::make_graphics_pipeline(
              device, {.vertex = caster_vert, .streams = position_stream(), .depth = VK_FORMAT_D32_SFLOAT}),
          gpu::make_graphics_pipeline(device, {.vertex = caster_masked_vert,
                                               .fragment = &caster_masked_frag,
                                               .more_sets = {scene.material_layout},
                                               .streams = position_and_attribute_streams(),
                                               .depth = VK_FORMAT_D32_SFLOAT})};
}

void begin_casters(gpu::Commands cmd, const CubeArray& store) {
  gpu::image_barrier(cmd, store.depth, use::nothing, use::depth_attachment);
}

void end_casters(gpu::Commands cmd, const CubeArray& store) {
  gpu::image_barrier(cmd, store.depth, use::depth_attachment, use::sampled);
}

void record_casters(gpu::Commands cmd, const CasterPipelines& pipelines, const GpuScene& scene, const CullState& culled,
                    const gpu::Buffer& views, const CubeArray& store, uint32_t cubes, uint32_t pass) {
  if (pass > 0) gpu::image_barrier(cmd, store.depth, use::depth_attachment, use::depth_attachment);
  begin_pass(cmd, store, cubes, pass == 0);
  const VkBuffer streams[]{scene.positions.handle, scene.vertex_attributes.handle};
  const VkDeviceSize offsets[]{0, 0};
  cmd->vkCmdBindVertexBuffers(cmd, 0, 2, streams, offsets);
  cmd->vkCmdBindIndexBuffer(cmd, scene.indices.handle, 0, VK_INDEX_TYPE_UINT32);
  const gpu::Pipeline* bound = nullptr;
  for (size_t i = 0; i < culled.lists.size(); ++i) {
    const bool opaque = culled.lists[i].material == pack::none;
    const gpu::Pipeline& pipeline = opaque ? pipelines.opaque : pipelines.masked;
    if (&pipeline != bound && opaque)
      gpu::bind(cmd, pipeline,
                {{"Views", gpu::storage(views)},
                 {"Draws", gpu::storage(culled.draws)},
                 {"Instances", gpu::storage(scene.instances)}});
    if (&pipeline != bound && !opaque)
      gpu::bind(cmd, pipeline,
                {{"Views", gpu::storage(views)},
                 {"Draws", gpu::storage(culled.draws)},
                 {"Instances", gpu::storage(scene.instances)},
                 {"Materials", gpu::storage(scene.materials)},
                 {"UvTransforms", gpu::storage(scene.uv_transforms)}});
    bound = &pipeline;
    if (!opaque)
      cmd->vkCmdBindDescriptorSets(cmd, VK_PIPELINE_BIND_POINT_GRAPHICS, pipeline.layout, 1, 1,
                                   &scene.material_sets[culled.lists[i].material], 0, nullptr);
    draw_list(cmd, culled, i, pass);
  }
  cmd->vkCmdEndRendering(cmd);
}

}  // namespace chandelier
