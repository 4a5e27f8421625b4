// SPDX-License-Identifier: Apache-2.0
// Visibility by rays on the CPU (Embree), the reference for shadow maps.
#pragma once

#include "shadows/filter/visibility_query.h"
#include "world/world.h"

namespace chandelier::truth {

/// Both sides of the world's triangles block light, as in shadow passes; holes of alpha tests let it through. `world`
/// must outlive the result. Each query uses all cores; make one query at a time. The first query builds Embree's scene,
/// and so does the first one after an instance moved or from an eye a kilometre away. Throws std::runtime_error, one
/// line.
VisibilitySource ray_traced_visibility(const World& world);

}  // namespace chandelier::truth
