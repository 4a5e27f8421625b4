// SPDX-License-Identifier: Apache-2.0
// Pass: moves a scene that is far from its origin to where floats are precise.
#pragma once

#include "../error.h"
#include "../report.h"
#include "../scene.h"

namespace chandelier::baker {

/// Sets scene.origin_m and makes it the origin of the world: of instances, lights, cameras, nodes and animations.
/// Meshes whose vertices are far from their own origin get a new one too. A scene near its origin stays the same bit
/// for bit. Warns of positions that the files' floats have rounded.
void recentre(Scene& scene, PassReport& pass, Warnings& warnings);

}  // namespace chandelier::baker
