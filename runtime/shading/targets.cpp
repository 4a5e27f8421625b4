// SPDX-License-Identifier: Apache-2.0
#include "shading/targets.h"

namespace chandelier {
namespace {

constexpr VkFormat surface_format = VK_FORMAT_R32G32B32A32_UINT;
constexpr VkFormat radiance_format = VK_FORMAT_R32G32B32A32_SFLOAT;
constexpr VkFormat depth_format = VK_FORMAT_D32_SFLOAT;
constexpr VkFormat middle_depth_format = VK_FORMAT_R32_SFLOAT;
constexpr VkImageUsageFlags drawn_color = VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT | VK_IMAGE_USAGE_SAMPLED_BIT;
constexpr VkImageUsageFlags drawn_depth = VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT | VK_IMAGE_USAGE_SAMPLED_BIT;
constexpr VkImageUsageFlags copied_later = VK_IMAGE_USAGE_STORAGE_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT;

SampleTargets make_sample_targets(const gpu::Device& device, uint32_t width, uint32_t height, uint32_t samples) {
  const auto image = [&](VkFormat format, VkImageUsageFlags usage) {
    return gpu::make_image(device,
                           {.format = format, .width = width, .height = height, .samples = samples, .usage = usage});
  };
  return {image(surface_format, drawn_color), image(depth_format, drawn_depth), image(radiance_format, drawn_color),
          image(middle_depth_format, drawn_color)};
}

}  // namespace

bool can_draw_samples(const gpu::Device& device, uint32_t samples) {
  if (samples == 1) return true;
  const bool is_known = samples == 2 || samples == 4 || samples == 8;  // shading/edges.glsl knows where these are
  return is_known && device.limits.standardSampleLocations &&
         gpu::can_have_samples(device, surface_format, drawn_color, samples) &&
         gpu::can_have_samples(device, radiance_format, drawn_color, samples) &&
         gpu::can_have_samples(device, depth_format, drawn_depth, samples) &&
         gpu::can_have_samples(device, middle_depth_format, drawn_color, samples);
}

Targets make_targets(const gpu::Device& device, uint32_t width, uint32_t height, uint32_t samples) {
  const auto image = [&](VkFormat format, VkImageUsageFlags usage) {
    return gpu::make_image(device, {.format = format, .width = width, .height = height, .usage = usage});
  };
  Targets targets{.width = width, .height = height, .samples = samples};
  if (samples == 1) {
    targets.surface = image(surface_format, drawn_color | VK_IMAGE_USAGE_TRANSFER_SRC_BIT);
    targets.depth = image(depth_format, drawn_depth | VK_IMAGE_USAGE_TRANSFER_SRC_BIT);
    targets.radiance = image(radiance_format, VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT | copied_later);
  } else {  // written by find_edges.comp; depth as a colour, since no shader stores into a depth image
    targets.surface = image(surface_format, VK_IMAGE_USAGE_SAMPLED_BIT | copied_later);
    targets.depth = image(VK_FORMAT_R32_SFLOAT, VK_IMAGE_USAGE_SAMPLED_BIT | copied_later);
    targets.radiance = image(radiance_format, copied_later);
    targets.of_samples = make_sample_targets(device, width, height, samples);
  }
  targets.shown = image(VK_FORMAT_R8G8B8A8_UNORM, copied_later);
  return targets;
}

uint64_t sample_target_bytes(uint32_t width, uint32_t height, uint32_t samples) {
  constexpr uint64_t sample_bytes = 16 + 4 + 16 + 4;
  return samples == 1 ? 0 : sample_bytes * samples * width * height;
}

}  // namespace chandelier
