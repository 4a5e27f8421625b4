// SPDX-License-Identifier: Apache-2.0
// Pass: decodes PNG, JPEG and WebP into formats that GPUs sample, with all mip levels.
#pragma once

#include <compare>
#include <cstdint>

#include "../cache.h"
#include "../error.h"
#include "../progress.h"
#include "../report.h"
#include "../scene.h"
#include "mips.h"
#include "pack_schema.h"
#include "strings.h"

namespace chandelier::baker {

enum class TextureMode {
  bc,    // BC1, BC3 and BC5 where they are smaller
  raw,   // RGBA8
  none,  // no textures
};

struct ImageSettings {
  TextureMode textures = TextureMode::bc;
  uint32_t max_size = 0;  // largest width or height, texels; 0: no limit
  bool strict = false;    // a damaged image is an error, and not a warning
};

struct ImageRequest {
  uint32_t image;  // of the scene
  ImageUse use;
  float alpha_cutoff = 0;  // with masked_color

  auto operator<=>(const ImageRequest&) const = default;
};

/// Fills images and image_data, and turns the textures' numbers of requests into numbers of images: requests that need
/// the same texels share an image. Takes the bytes out of the scene. Throws Error.
void make_images(Scene& scene, const std::vector<ImageRequest>& requests, const ImageSettings& settings,
                 const Progress& progress, Cache& cache, PassReport& report, Warnings& warnings, Strings& strings,
                 pack::Contents& pack);

}  // namespace chandelier::baker
