// SPDX-License-Identifier: Apache-2.0
// The cache keys of stages: hashes of everything that they depend on.
#pragma once

#include "../cache.h"
#include "../scene.h"
#include "bake.h"

namespace chandelier::baker {

/// The entry of what bake_geometry() makes: of everything in the scene but lights, cameras, images' bytes and the
/// places that messages name.
std::string geometry_entry(const Scene& scene, const BakeSettings& settings);

}  // namespace chandelier::baker
