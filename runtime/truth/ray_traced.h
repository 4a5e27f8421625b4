// SPDX-License-Identifier: Apache-2.0
// Visibility by rays on the CPU (Embree): what shadow maps are measured against.
#pragma once

#include "frame/visibility_query.h"
#include "world/world.h"

namespace chandelier::truth {

/// Answers for the triangles of a world, whichever side they show, as shadow passes draw them; what an alpha test cuts
/// out lets light through. `world` must outlive the answers. Each uses all cores, one at a time. The first one, and the
/// first after an instance moved or from an eye a kilometre on, takes the time to build Embree's scene. Throws
/// std::runtime_error, one line.
VisibilitySource ray_traced_visibility(const World& world);

}  // namespace chandelier::truth
