// SPDX-License-Identifier: Apache-2.0
// Pass: which surfaces throw no shadow because light passes through them.
#pragma once

#include "../error.h"
#include "../report.h"
#include "../scene.h"
#include "images.h"

namespace chandelier::baker {

/// Marks materials that let half of the light through or more as shadowless, unless their author has said what they do
/// (Material::shadow). Where a texture decides, triangles of glass get a material of their own. One warning names all
/// of them. With `glass_shadows` nothing happens. Throws Error where a texture that decides cannot be decoded, or
/// is damaged and that is `strict`. Without textures nothing is decoded: factors alone decide.
void find_glass(Scene& scene, bool glass_shadows, const ImageSettings& images, PassReport& pass, Warnings& warnings);

}  // namespace chandelier::baker
