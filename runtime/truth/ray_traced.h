// SPDX-License-Identifier: Apache-2.0
// Visibility by rays on the CPU (Embree): what shadow maps are measured against.
#pragma once

#include "frame/visibility_query.h"
#include "pack_schema.h"

namespace chandelier::truth {

/// Answers for the triangles of a pack at rest, whichever side they show, as shadow passes draw them; what an alpha
/// test cuts out lets light through. What `pack` points to must outlive the answers. Each uses all cores, one at a
/// time. The first one, and the first from an eye a kilometre on, takes the time to build Embree's scene. Throws
/// std::runtime_error, one line.
VisibilitySource ray_traced_visibility(const pack::View& pack);

}  // namespace chandelier::truth
