// SPDX-License-Identifier: Apache-2.0
// Mip levels of an image, averaged by the meaning of its texels.
#pragma once

#include <cstdint>
#include <vector>

namespace chandelier::baker {

/// What an image's texels mean, and so how they are averaged from level to level.
enum class ImageUse {
  color,         // sRGB, alpha ignored: averaged in linear light
  masked_color,  // sRGB whose alpha is tested: averaged in linear light by its alpha, whose coverage every level keeps
  data,          // averaged as it is
  normal,        // averaged; all levels unit length
};

struct Texels {
  uint32_t width = 0;
  uint32_t height = 0;
  std::vector<uint8_t> rgba;  // rows from the top
};

/// sRGB's curve: of an 8-bit value, and the nearest 8-bit value of a linear one (0 to 1, clamped).
float linear_of_srgb(uint8_t code);
uint8_t srgb_of_linear(float value);

uint32_t mip_level_count(uint32_t width, uint32_t height);

/// All levels down to 1×1, largest first, level n max(1, size >> n) wide and high; those above `max_size` are left out
/// (0: none). With masked_color, `alpha_cutoff` (0 to 1) is the smallest visible alpha. The result does not depend on
/// the number of threads.
std::vector<Texels> mip_chain(Texels&& top, ImageUse use, float alpha_cutoff = 0, uint32_t max_size = 0);

}  // namespace chandelier::baker
