// SPDX-License-Identifier: Apache-2.0
// Animations: keys that move nodes.
#pragma once

#include <cstdint>

#include "../scene.h"
#include "gltf.h"

namespace chandelier::baker {

/// The animations that move nodes for which `in_scene` is true. Channels' nodes are glTF's numbers. Weights of morph
/// targets are left out with a warning. Throws Error.
std::vector<Animation> read_animations(const Gltf& gltf, const std::vector<uint8_t>& in_scene, Warnings& warnings);

}  // namespace chandelier::baker
