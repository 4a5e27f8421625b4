// SPDX-License-Identifier: Apache-2.0
// The two images of a specular-glossiness material into those of a metallic-roughness one.
#pragma once

#include "../scene.h"
#include "mips.h"

namespace chandelier::baker {

struct MetallicTexels {
  Texels base_color;          // RGB sRGB, and the diffuse image's alpha
  Texels metallic_roughness;  // G roughness, B metallic
};

/// Texel by texel, in the larger size of the two images; the other is interpolated. Either may be absent.
MetallicTexels convert_texels(const SpecularGlossiness& factors, const Texels* diffuse, const Texels* glossy);

}  // namespace chandelier::baker
