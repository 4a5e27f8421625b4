// SPDX-License-Identifier: Apache-2.0
// Pass: tangents for normal maps, from positions and texture coordinates.
#pragma once

#include <cstddef>

#include "../scene.h"

namespace chandelier::baker {

/// Replaces all tangents of a welded primitive. A vertex between mirrored and plain texture coordinates becomes two.
void make_tangents(Primitive& primitive);

/// Welds each primitive that needs tangents, and makes them; returns how many there were.
size_t make_tangents(Scene& scene);

}  // namespace chandelier::baker
