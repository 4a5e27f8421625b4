// SPDX-License-Identifier: Apache-2.0
// Converts the two images of a specular-glossiness material to those of a metallic-roughness material.
#pragma once

#include "../scene.h"
#include "mips.h"

namespace chandelier::baker {

struct MetallicTexels {
  Texels base_color;          // RGB sRGB, and the diffuse image's alpha
  Texels metallic_roughness;  // G roughness, B metallic
};

/// Converts texel by texel in the size of the larger image; the other one is interpolated. Either may be absent.
MetallicTexels convert_texels(const SpecularGlossiness& factors, const Texels* diffuse, const Texels* glossy);

}  // namespace chandelier::baker
