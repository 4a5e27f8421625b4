// SPDX-License-Identifier: Apache-2.0
// Moves a scene that lies far from its origin to where floats are fine.
#pragma once

#include "../error.h"
#include "../report.h"
#include "../scene.h"

namespace chandelier::baker {

/// Sets scene.origin_m, and has the world begin there: instances, lights, cameras and what moves. Meshes whose vertices
/// lie far from their own origin get another one too. A scene near its origin stays bit for bit as it is. Warns of what
/// the files' floats have rounded already.
void recentre(Scene& scene, PassReport& pass, Warnings& warnings);

}  // namespace chandelier::baker
