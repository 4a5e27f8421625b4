// SPDX-License-Identifier: Apache-2.0
#include "shading/g_buffer.h"

#include <volk.h>

#include "shaders/g_buffer_frag.h"
#include "shaders/g_buffer_vert.h"
#include "shading/occlusion.h"

namespace chandelier {
namespace {

void begin_pass(gpu::Commands cmd, const Targets& targets) {
  const auto attachment = [](const gpu::Image& image, VkImageLayout layout) {
    return VkRenderingAttachmentInfo{.sType = VK_STRUCTURE_TYPE_RENDERING_ATTACHMENT_INFO,
                                     .imageView = image.view,
                                     .imageLayout = layout,
                                     .loadOp = VK_ATTACHMENT_LOAD_OP_CLEAR,
                                     .storeOp = VK_ATTACHMENT_STORE_OP_STORE,
                                     .clearValue = {}};
  };
  VkRenderingAttachmentInfo colors[]{attachment(targets.surface, VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL),
                                     attachment(targets.radiance, VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL)};
  colors[1].clearValue.color.float32[3] = alpha_of_occlusion(1.0f);
  const auto depth = attachment(targets.depth, VK_IMAGE_LAYOUT_DEPTH_ATTACHMENT_OPTIMAL);
  const VkRenderingInfo info{.sType = VK_STRUCTURE_TYPE_RENDERING_INFO,
                             .renderArea = {{0, 0}, {targets.width, targets.height}},
                             .layerCount = 1,
                             .colorAttachmentCount = 2,
                             .pColorAttachments = colors,
                             .pDepthAttachment = &depth};
  cmd->vkCmdBeginRendering(cmd, &info);
  gpu::set_viewport(cmd, targets.width, targets.height);
}

}  // namespace

gpu::Pipeline make_g_buffer_pipeline(const gpu::Device& device, const GpuScene& scene) {
  return gpu::make_graphics_pipeline(device, {.vertex = g_buffer_vert,
                                              .fragment = &g_buffer_frag,
                                              .more_sets = {scene.material_layout},
                                              .streams = position_and_attribute_streams(),
                                              .colors = {VK_FORMAT_R32G32B32A32_UINT, VK_FORMAT_R32G32B32A32_SFLOAT},
                                              .depth = VK_FORMAT_D32_SFLOAT});
}

void record_g_buffer(gpu::Commands cmd, const gpu::Pipeline& pipeline, const GpuScene& scene, const CullState& culled,
                     const gpu::Buffer& view, const Targets& targets) {
  gpu::image_barrier(cmd, targets.surface, use::nothing, use::color_attachment);
  gpu::image_barrier(cmd, targets.radiance, use::nothing, use::color_attachment);
  gpu::image_barrier(cmd, targets.depth, use::nothing, use::depth_attachment);
  begin_pass(cmd, targets);
  const VkBuffer streams[]{scene.positions.handle, scene.vertex_attributes.handle};
  const VkDeviceSize offsets[]{0, 0};
  cmd->vkCmdBindVertexBuffers(cmd, 0, 2, streams, offsets);
  cmd->vkCmdBindIndexBuffer(cmd, scene.indices.handle, 0, VK_INDEX_TYPE_UINT32);
  gpu::bind(cmd, pipeline,
            {{"Views", gpu::storage(view)},
             {"Draws", gpu::storage(culled.draws)},
             {"Instances", gpu::storage(scene.instances)},
             {"Materials", gpu::storage(scene.materials)},
             {"UvTransforms", gpu::storage(scene.uv_transforms)}});
  for (size_t i = 0; i < culled.lists.size(); ++i) {
    const DrawList& list = culled.lists[i];
    cmd->vkCmdSetCullMode(cmd, scene.double_sided[list.material] ? VK_CULL_MODE_NONE : VK_CULL_MODE_BACK_BIT);
    cmd->vkCmdBindDescriptorSets(cmd, VK_PIPELINE_BIND_POINT_GRAPHICS, pipeline.layout, 1, 1,
                                 &scene.material_sets[list.material], 0, nullptr);
    draw_list(cmd, culled, i, 0);
  }
  cmd->vkCmdEndRendering(cmd);
  gpu::image_barrier(cmd, targets.surface, use::color_attachment, use::sampled);
  gpu::image_barrier(cmd, targets.radiance, use::color_attachment, use::storage);
  gpu::image_barrier(cmd, targets.depth, use::depth_attachment, use::sampled);
}

}  // namespace chandelier
