// SPDX-License-Identifier: Apache-2.0
// Pass: triangles that show nothing go: those without an area, and those that another one repeats.
#pragma once

#include "packed.h"

namespace chandelier::baker {

struct CleanCounts {
  std::uint64_t degenerate = 0, duplicate = 0;
};

/// A duplicate has the same places, the same front and the same material as an earlier triangle of its mesh, and where
/// that is masked the same texture coordinates and colours, as its holes depend on them. A mesh that a skin bends
/// (`rigid` false) loses only triangles with a vertex twice: what is flat or doubled in the bind pose may come apart.
/// The order of the others stays. Vertices stay too: what no triangle uses is left out when they are put in order.
CleanCounts clean(PackedMesh& mesh, const std::vector<Material>& materials, bool rigid);

/// For each vertex of the mesh, counted through its primitives, the first at the same place.
std::vector<std::uint32_t> places_of(const PackedMesh& mesh);

}  // namespace chandelier::baker
