// SPDX-License-Identifier: Apache-2.0
// Pass: triangles that show nothing go: those without an area, and those that another one repeats.
#pragma once

#include "packed.h"

namespace chandelier::baker {

struct CleanCounts {
  std::uint64_t degenerate = 0, duplicate = 0;
};

/// A duplicate has the same places, the same front and the same material as an earlier triangle of its mesh. The order
/// of the others stays. Vertices stay too: what no triangle uses is left out when they are put in order.
CleanCounts clean(PackedMesh& mesh);

/// For each vertex of the mesh, counted through its primitives, the first at the same place.
std::vector<std::uint32_t> places_of(const PackedMesh& mesh);

}  // namespace chandelier::baker
