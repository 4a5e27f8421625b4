// SPDX-License-Identifier: Apache-2.0
// The cache keys of stages: hashes of everything that they depend on.
#pragma once

#include "../cache.h"
#include "../scene.h"
#include "bake.h"

namespace chandelier::baker {

/// The name of the cache entry of bake_geometry(): a hash of everything in the scene except lights, cameras, the bytes
/// of images and places named in messages.
std::string geometry_entry(const Scene& scene, const BakeSettings& settings);

}  // namespace chandelier::baker
