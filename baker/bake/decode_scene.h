// SPDX-License-Identifier: Apache-2.0
// Texels of a scene's images, including those that are converted from others.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "../error.h"
#include "../scene.h"
#include "mips.h"

namespace chandelier::baker {

/// Calls `visit` with each image whose bytes an image is decoded from: itself, or those that it is converted from.
template <typename Visit>
void for_each_source(const Scene& scene, uint32_t image, Visit visit) {
  const std::optional<SpecularGlossiness>& from = scene.images[image].converted_from;
  if (!from) return visit(image);
  for (const uint32_t source : {from->diffuse, from->specular_glossiness}) {
    if (source != no_index) visit(source);
  }
}

/// The number of texels in memory while an image is decoded, according to the headers of its sources.
uint64_t claimed_texels(const Scene& scene, uint32_t image);

/// Texels for use as colour and for all other uses. `data` is set only if the image is converted from others.
struct SceneTexels {
  Texels color;
  std::optional<Texels> data;
  std::vector<std::string> damage;  // of each source, in order; see DecodedTexels

  const Texels& as(ImageUse use) const {
    const bool is_color = use == ImageUse::color || use == ImageUse::masked_color;
    return is_color || !data ? color : *data;
  }
};

/// Throws Error if the image, or one that it is converted from, cannot be decoded; or if the two sources differ so much
/// in shape that an image of the larger width and height would be far larger than both.
SceneTexels decode_image(const Scene& scene, uint32_t image);

/// Warns of each damaged source of an image, once; `strict` throws Error instead.
void report_damage(Scene& scene, uint32_t image, const std::vector<std::string>& damage, bool strict,
                   Warnings& warnings);

}  // namespace chandelier::baker
