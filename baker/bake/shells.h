// SPDX-License-Identifier: Apache-2.0
// Pass: which surfaces are closed, so that shadow maps may leave out the half that faces away.
#pragma once

#include <cstdint>

#include "packed.h"

namespace chandelier::baker {

struct ShellCounts {
  uint64_t shells = 0, closed = 0;  // closed: and oriented outwards
  uint64_t closed_triangles = 0;
};

/// Sets PackedPrimitive::closed. A shell is a set of triangles connected by edges, over all primitives of the mesh. It
/// is closed if every edge has exactly two triangles that run along it in opposite directions, and it is oriented
/// outwards if its volume is positive. A shell counts as open if a triangle of it is masked or casts no shadow, since
/// light gets inside, or if a skin bends it (`rigid` false), since its vertices come apart. Double-sided materials make
/// no difference: a shell's back hides the same light as its front.
ShellCounts find_shells(PackedMesh& mesh, const std::vector<Material>& materials, bool rigid);

}  // namespace chandelier::baker
