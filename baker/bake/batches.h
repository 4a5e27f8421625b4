// SPDX-License-Identifier: Apache-2.0
// Pass: meshes into batches of about a hundred neighbouring triangles.
#pragma once

#include <cstdint>

#include "../scene.h"
#include "packed.h"

namespace chandelier::baker {

/// Numbers of a scene mesh's records among the pack's meshes, as modelled and with its triangles' winding reversed;
/// no_index where it has no triangles or no instance needs it.
struct MeshRecords {
  uint32_t plain = no_index;
  uint32_t mirrored = no_index;
};

bool is_mirrored(const MeshInstance& instance);

/// Fills positions, vertex_attributes, skin_vertices, indices, batches and meshes; empties `meshes`, which are those of
/// the scene. The batches of a mesh come in the order of its primitives; within one the closed ones first, and
/// neighbours near each other. The result does not depend on the number of threads. Throws Error.
std::vector<MeshRecords> make_batches(const Scene& scene, std::vector<PackedMesh>& meshes, uint32_t batch_triangles,
                                      pack::Contents& pack);

}  // namespace chandelier::baker
