// SPDX-License-Identifier: Apache-2.0
// Pass: makes normals where the file has none.
#pragma once

#include <cstddef>

#include "../scene.h"

namespace chandelier::baker {

/// Gives each triangle its flat normal, as glTF requires. If `smooth_angle_rad` is above 0, the normals of neighbours
/// across an edge are averaged, weighted by their angles, where they differ by at most that. A vertex with several
/// normals becomes several.
void make_normals(Primitive& primitive, float smooth_angle_rad);

/// The same for each primitive that needs it; returns how many did.
size_t make_normals(Scene& scene, float smooth_angle_rad);

}  // namespace chandelier::baker
