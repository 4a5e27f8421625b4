// SPDX-License-Identifier: Apache-2.0
#include "shading/tone_map.h"

#include <volk.h>

#include "frame_schema.h"
#include "shaders/exposure_comp.h"
#include "shaders/tone_map_comp.h"

namespace chandelier {
namespace {

uint32_t groups(uint32_t pixels) {
  return (pixels + 15) / 16;
}

void computed_before_compute(gpu::Commands cmd) {
  gpu::memory_barrier(cmd, VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT, VK_ACCESS_2_SHADER_STORAGE_WRITE_BIT,
                      VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT,
                      VK_ACCESS_2_SHADER_STORAGE_READ_BIT | VK_ACCESS_2_SHADER_STORAGE_WRITE_BIT);
}

}  // namespace

TonePipelines make_tone_pipelines(const gpu::Device& device) {
  return {gpu::make_compute_pipeline(device, exposure_comp, {{"pass", 0}}),
          gpu::make_compute_pipeline(device, exposure_comp, {{"pass", 1}}),
          gpu::make_compute_pipeline(device, tone_map_comp)};
}

gpu::Buffer make_luminance_sums(const gpu::Device& device, uint32_t width, uint32_t height) {
  return gpu::make_buffer(device, VkDeviceSize{groups(width)} * groups(height) * sizeof(frame::LuminanceSum),
                          VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_TRANSFER_SRC_BIT, gpu::Memory::device);
}

void record_tone_map(gpu::Commands cmd, const TonePipelines& pipelines, std::optional<float> exposure_ev,
                     const gpu::Buffer& sums, const Targets& targets) {
  const uint32_t columns = groups(targets.width);
  const uint32_t rows = groups(targets.height);
  const frame::ToneConstants constants{
      .exposure_ev = exposure_ev.value_or(0.0f), .automatic = exposure_ev ? 0u : 1u, .group_count = columns * rows};
  gpu::image_barrier(cmd, targets.radiance, use::storage, use::storage);
  gpu::bind(cmd, pipelines.sum,
            {{"radiance_image", gpu::storage_image(targets.radiance)}, {"Sums", gpu::storage(sums)}});
  gpu::push_constants(cmd, pipelines.sum, constants);
  cmd->vkCmdDispatch(cmd, columns, rows, 1);
  computed_before_compute(cmd);
  gpu::bind(cmd, pipelines.expose,
            {{"radiance_image", gpu::storage_image(targets.radiance)}, {"Sums", gpu::storage(sums)}});
  gpu::push_constants(cmd, pipelines.expose, constants);
  cmd->vkCmdDispatch(cmd, 1, 1, 1);
  computed_before_compute(cmd);
  gpu::image_barrier(cmd, targets.shown, use::nothing, use::storage);
  gpu::bind(cmd, pipelines.tone_map,
            {{"radiance_image", gpu::storage_image(targets.radiance)},
             {"Sums", gpu::storage(sums)},
             {"shown_image", gpu::storage_image(targets.shown)}});
  gpu::dispatch_over(cmd, pipelines.tone_map, targets.width, targets.height);
  gpu::image_barrier(cmd, targets.shown, use::storage, use::copied);
}

}  // namespace chandelier
