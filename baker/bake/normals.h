// SPDX-License-Identifier: Apache-2.0
// Pass: makes normals where the file has none.
#pragma once

#include <cstddef>

#include "../scene.h"

namespace chandelier::baker {

/// Gives each triangle its flat normal, which is what glTF asks for; above 0, neighbours across an edge whose normals
/// differ by at most `smooth_angle_rad` are smoothed, weighted by their angles. A vertex with several normals becomes
/// several.
void make_normals(Primitive& primitive, float smooth_angle_rad);

/// The same for each primitive that needs it; returns how many did.
size_t make_normals(Scene& scene, float smooth_angle_rad);

}  // namespace chandelier::baker
