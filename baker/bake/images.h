// SPDX-License-Identifier: Apache-2.0
// Pass: PNG and JPEG bytes into RGBA8 texels with all mip levels.
#pragma once

#include "../progress.h"
#include "../scene.h"
#include "pack_schema.h"
#include "strings.h"

namespace chandelier::baker {

/// How texels are averaged from level to level.
enum class ImageUse {
  color,   // sRGB: averaged in linear light
  data,    // averaged as it is
  normal,  // averaged, then made unit length again
};

struct Texels {
  std::uint32_t width = 0;
  std::uint32_t height = 0;
  std::vector<std::uint8_t> rgba;  // rows from the top
};

/// Throws Error above 16384 texels, or below 1.
void check_image_size(std::int64_t width, std::int64_t height, const std::string& where);

/// Throws Error for what is neither PNG nor JPEG, is damaged or too large.
Texels decode_image(const EncodedImage& image);

std::uint32_t mip_level_count(std::uint32_t width, std::uint32_t height);

/// All levels down to 1×1, largest first, level n max(1, size >> n) wide and high.
std::vector<std::uint8_t> mip_chain(Texels&& top, ImageUse use);

struct ImageRequest {
  std::uint32_t image;  // of the scene
  ImageUse use;
};

/// Fills images and image_data, one image per request; takes the bytes out of the scene. Throws Error.
void make_images(Scene& scene, const std::vector<ImageRequest>& requests, const Progress& progress, Strings& strings,
                 pack::Contents& pack);

}  // namespace chandelier::baker
