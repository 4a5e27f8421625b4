// SPDX-License-Identifier: Apache-2.0
// Pass: finds surfaces that cast no shadow because light passes through them.
#pragma once

#include "../error.h"
#include "../report.h"
#include "../scene.h"
#include "images.h"

namespace chandelier::baker {

/// Marks materials that let half of the light or more through as shadowless, unless their author has decided
/// (Material::shadow). If a texture decides, triangles of glass get a material of their own. One warning names all of
/// them. With `glass_shadows` nothing happens. Throws Error if a deciding texture cannot be decoded, or is damaged and
/// `strict` is set. Without textures nothing is decoded, and factors alone decide.
void find_glass(Scene& scene, bool glass_shadows, const ImageSettings& images, PassReport& pass, Warnings& warnings);

}  // namespace chandelier::baker
