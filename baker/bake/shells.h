// SPDX-License-Identifier: Apache-2.0
// Pass: which surfaces are closed, so that shadow maps may leave out the half that faces away.
#pragma once

#include "packed.h"

namespace chandelier::baker {

struct ShellCounts {
  std::uint64_t shells = 0, closed = 0;  // closed: and oriented outwards
  std::uint64_t closed_triangles = 0;
};

/// Sets PackedPrimitive::closed. A shell is what hangs together by edges, over all primitives of the mesh; it is closed
/// where every edge has exactly two triangles that run along it in opposite directions, oriented outwards where its
/// volume is positive. A shell with a masked triangle, or one that throws no shadow, counts as open: light gets inside.
/// So does a mesh that a skin bends (`rigid` false), whose places come apart. Double-sided materials make no
/// difference: what closes is the geometry, and a shell's back hides the same light as its front.
ShellCounts find_shells(PackedMesh& mesh, const std::vector<Material>& materials, bool rigid);

}  // namespace chandelier::baker
