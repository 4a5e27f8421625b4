// SPDX-License-Identifier: Apache-2.0
#include "shading/g_buffer.h"

#include <volk.h>

#include "shaders/g_buffer_frag.h"
#include "shaders/g_buffer_samples_frag.h"
#include "shaders/g_buffer_vert.h"
#include "shading/occlusion.h"

namespace chandelier {
namespace {

// What is drawn into.
struct Attachments {
  const gpu::Image& surface;
  const gpu::Image& depth;
  const gpu::Image& radiance;
  const gpu::Image* middle_depth;  // of samples alone
};

Attachments attachments_of(const Targets& targets) {
  if (targets.samples == 1) return {targets.surface, targets.depth, targets.radiance, nullptr};
  const SampleTargets& of_samples = targets.of_samples;
  return {of_samples.surface, of_samples.depth, of_samples.radiance, &of_samples.middle_depth};
}

void begin_pass(gpu::Commands cmd, const Targets& targets, const Attachments& drawn) {
  const auto attachment = [](const gpu::Image& image, VkImageLayout layout) {
    return VkRenderingAttachmentInfo{.sType = VK_STRUCTURE_TYPE_RENDERING_ATTACHMENT_INFO,
                                     .imageView = image.view,
                                     .imageLayout = layout,
                                     .loadOp = VK_ATTACHMENT_LOAD_OP_CLEAR,
                                     .storeOp = VK_ATTACHMENT_STORE_OP_STORE,
                                     .clearValue = {}};
  };
  VkRenderingAttachmentInfo colors[3]{attachment(drawn.surface, VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL),
                                      attachment(drawn.radiance, VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL)};
  colors[1].clearValue.color.float32[3] = alpha_of_occlusion(1.0f);
  if (drawn.middle_depth) colors[2] = attachment(*drawn.middle_depth, VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL);
  const auto depth = attachment(drawn.depth, VK_IMAGE_LAYOUT_DEPTH_ATTACHMENT_OPTIMAL);
  const VkRenderingInfo info{.sType = VK_STRUCTURE_TYPE_RENDERING_INFO,
                             .renderArea = {{0, 0}, {targets.width, targets.height}},
                             .layerCount = 1,
                             .colorAttachmentCount = drawn.middle_depth ? 3u : 2u,
                             .pColorAttachments = colors,
                             .pDepthAttachment = &depth};
  cmd->vkCmdBeginRendering(cmd, &info);
  gpu::set_viewport(cmd, targets.width, targets.height);
}

}  // namespace

gpu::Pipeline make_g_buffer_pipeline(const gpu::Device& device, const GpuScene& scene, uint32_t samples) {
  gpu::Constants constants;
  std::vector<VkFormat> colors{VK_FORMAT_R32G32B32A32_UINT, VK_FORMAT_R32G32B32A32_SFLOAT};
  if (samples > 1) {
    constants.push_back({"samples", samples});
    colors.push_back(VK_FORMAT_R32_SFLOAT);  // middle_depth
  }
  return gpu::make_graphics_pipeline(device, {.vertex = g_buffer_vert,
                                              .fragment = samples == 1 ? &g_buffer_frag : &g_buffer_samples_frag,
                                              .more_sets = {scene.material_layout},
                                              .streams = position_and_attribute_streams(),
                                              .colors = colors,
                                              .depth = VK_FORMAT_D32_SFLOAT,
                                              .constants = constants,
                                              .samples = samples});
}

void record_g_buffer(gpu::Commands cmd, const gpu::Pipeline& pipeline, const GpuScene& scene, const CullState& culled,
                     const gpu::Buffer& view, const Targets& targets) {
  const Attachments drawn = attachments_of(targets);
  gpu::image_barrier(cmd, drawn.surface, use::nothing, use::color_attachment);
  gpu::image_barrier(cmd, drawn.radiance, use::nothing, use::color_attachment);
  gpu::image_barrier(cmd, drawn.depth, use::nothing, use::depth_attachment);
  if (drawn.middle_depth) gpu::image_barrier(cmd, *drawn.middle_depth, use::nothing, use::color_attachment);
  begin_pass(cmd, targets, drawn);
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
  gpu::image_barrier(cmd, drawn.surface, use::color_attachment, use::sampled);
  gpu::image_barrier(cmd, drawn.radiance, use::color_attachment, targets.samples == 1 ? use::storage : use::sampled);
  gpu::image_barrier(cmd, drawn.depth, use::depth_attachment, use::sampled);
  if (drawn.middle_depth) gpu::image_barrier(cmd, *drawn.middle_depth, use::color_attachment, use::sampled);
}

}  // namespace chandelier
