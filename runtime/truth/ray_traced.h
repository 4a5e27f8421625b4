// SPDX-License-Identifier: Apache-2.0
// Visibility by rays on the CPU (Embree): what shadow maps are measured against.
#pragma once

#include "frame/visibility_query.h"
#include "pack_schema.h"

namespace chandelier::truth {

/// Answers for the triangles of a pack at rest, whichever side they show, as shadow passes draw them; what an alpha
/// test cuts out lets light through. `pack` is not needed afterwards. Uses all cores. Throws std::runtime_error, one
/// line.
VisibilitySource ray_traced_visibility(const pack::View& pack);

}  // namespace chandelier::truth
