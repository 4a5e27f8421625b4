// SPDX-License-Identifier: Apache-2.0
// What a material reflects on average: its factors, and its textures' mean colours. Plain C++, no Vulkan.
#pragma once

#include <glm/glm.hpp>
#include <vector>

#include "pack_schema.h"

namespace chandelier {

struct MeanMaterial {
  glm::vec3 base_color;  // linear
  glm::vec3 emissive;    // linear
  float metallic;
  float roughness;
  bool unlit;
  bool double_sided;
};

/// One per material of the pack. A texture's mean is that of its smallest level.
std::vector<MeanMaterial> mean_materials(const pack::View& pack);
/// That function, for code that must link without it: the preview's library has no decoder of images.
using MeanMaterialsOf = std::vector<MeanMaterial> (*)(const pack::View&);

/// shading/brdf.glsl:ggx on the CPU. Directions of unit length, all on the surface's lit side.
glm::vec3 reflected(const MeanMaterial& material, const glm::vec3& normal, const glm::vec3& to_eye,
                    const glm::vec3& to_light);

}  // namespace chandelier
