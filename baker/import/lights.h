// SPDX-License-Identifier: Apache-2.0
// Lights: KHR_lights_punctual, and what their author adds in `extras.chandelier` (light_extras.schema.json).
#pragma once

#include <cstddef>
#include <set>

#include "../scene.h"
#include "gltf.h"
#include "nodes.h"

namespace chandelier::baker {

/// Appends the node's light to the scene, if it has one. `seen`: lights that other nodes have shown already; their
/// warnings are not repeated. Throws Error.
void add_light(const Gltf& gltf, const PlacedNode& placed, std::set<size_t>& seen, Scene& scene, Warnings& warnings);

}  // namespace chandelier::baker
