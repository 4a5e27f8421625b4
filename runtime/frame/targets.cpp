// SPDX-License-Identifier: Apache-2.0
#include "frame/targets.h"

#include <volk.h>

namespace chandelier {

Targets make_targets(const gpu::Device& device, uint32_t width, uint32_t height) {
  const auto image = [&](VkFormat format, VkImageUsageFlags usage) {
    return gpu::make_image(device, {.format = format, .width = width, .height = height, .usage = usage});
  };
  constexpr VkImageUsageFlags read_later = VK_IMAGE_USAGE_SAMPLED_BIT;
  constexpr VkImageUsageFlags copied_later = VK_IMAGE_USAGE_STORAGE_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT;
  return {image(VK_FORMAT_R32G32B32A32_UINT,
                VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT | read_later | VK_IMAGE_USAGE_TRANSFER_SRC_BIT),
          image(VK_FORMAT_D32_SFLOAT,
                VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT | read_later | VK_IMAGE_USAGE_TRANSFER_SRC_BIT),
          image(VK_FORMAT_R32G32B32A32_SFLOAT, VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT | copied_later),
          image(VK_FORMAT_R8G8B8A8_UNORM, copied_later),
          width,
          height};
}

gpu::Owned<VkSampler> make_texel_sampler(const gpu::Device& device) {
  return gpu::make_sampler(device, {.sType = VK_STRUCTURE_TYPE_SAMPLER_CREATE_INFO,
                                    .addressModeU = VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE,
                                    .addressModeV = VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE,
                                    .addressModeW = VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE});
}

void set_viewport(gpu::Commands cmd, uint32_t width, uint32_t height) {
  const VkViewport viewport{0.0f, 0.0f, static_cast<float>(width), static_cast<float>(height), 0.0f, 1.0f};
  const VkRect2D scissor{{0, 0}, {width, height}};
  cmd->vkCmdSetViewport(cmd, 0, 1, &viewport);
  cmd->vkCmdSetScissor(cmd, 0, 1, &scissor);
}

}  // namespace chandelier
