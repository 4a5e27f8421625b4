// SPDX-License-Identifier: Apache-2.0
// A hierarchy over each mesh's triangles, with the area below each node, for splatting nodes as points (Many Perfect
// Shadow Maps: a node whose projected area is under a texel is drawn as a point).
#pragma once

#include "../report.h"
#include "pack_schema.h"

namespace chandelier::baker {

/// Fills triangle_bvh, triangle_bvh_items, triangle_bvh_areas, and the node numbers of `meshes`. Throws Error.
void make_triangle_bvh(PassReport& pass, pack::Contents& pack);

}  // namespace chandelier::baker
