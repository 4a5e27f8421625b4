// SPDX-License-Identifier: Apache-2.0
// Pass: materials and their textures; says which images are needed, and as what.
#pragma once

#include "../scene.h"
#include "images.h"
#include "pack_schema.h"
#include "strings.h"

namespace chandelier::baker {

/// Fills materials and textures. Returns the images that the textures' numbers count, for make_images.
std::vector<ImageRequest> make_materials(const Scene& scene, Strings& strings, pack::Contents& pack);

}  // namespace chandelier::baker
