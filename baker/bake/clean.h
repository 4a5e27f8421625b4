// SPDX-License-Identifier: Apache-2.0
// Pass: removes triangles that show nothing: those without an area, and those that repeat another one.
#pragma once

#include <cstdint>

#include "packed.h"

namespace chandelier::baker {

struct CleanCounts {
  uint64_t degenerate = 0, duplicate = 0;
};

/// A duplicate has the same positions, front and material as an earlier triangle of its mesh. If the material is
/// masked, texture coordinates and colours must be equal too, since the holes depend on them. A mesh that a skin bends
/// (`rigid` false) loses only triangles with a vertex twice: triangles that are flat or doubled in the bind pose may
/// come apart. The order of the others stays. Vertices stay too; the ones that no triangle uses are dropped later, when
/// vertices are sorted.
CleanCounts clean(PackedMesh& mesh, const std::vector<Material>& materials, bool rigid);

/// For each vertex of the mesh, counted through its primitives, the first at the same place.
std::vector<uint32_t> places_of(const PackedMesh& mesh);

}  // namespace chandelier::baker
