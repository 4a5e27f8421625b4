// SPDX-License-Identifier: Apache-2.0
#include "shading/targets.h"

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

}  // namespace chandelier
