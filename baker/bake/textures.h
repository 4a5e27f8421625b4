// SPDX-License-Identifier: Apache-2.0
// Pass: materials and their textures; returns which images are needed, and for which use.
#pragma once

#include "../scene.h"
#include "images.h"
#include "pack_schema.h"
#include "strings.h"

namespace chandelier::baker {

/// Fills materials and, with `textures`, textures. Returns the requests for make_images; until that runs, a texture's
/// image is the number of a request. Without textures, factors alone remain, and a material with an emissive texture
/// does not glow.
std::vector<ImageRequest> make_materials(const Scene& scene, bool textures, Strings& strings, pack::Contents& pack);

}  // namespace chandelier::baker
