// SPDX-License-Identifier: Apache-2.0
// Pass: meshes into batches of about a hundred neighbouring triangles.
#pragma once

#include "../progress.h"
#include "../scene.h"
#include "pack_schema.h"

namespace chandelier::baker {

/// Batches [first, first + count) of the pack.
struct BatchRange {
  std::uint32_t first = 0;
  std::uint32_t count = 0;
};

/// A mesh's batches, as modelled and with its triangles' winding reversed; empty where no instance needs them.
struct MeshBatches {
  BatchRange plain;
  BatchRange mirrored;
};

bool is_mirrored(const MeshInstance& instance);

/// Fills positions, vertex_attributes, indices and batches; takes the meshes' vertices out of the scene. The result
/// does not depend on the number of threads. Throws Error.
std::vector<MeshBatches> make_batches(Scene& scene, std::uint32_t batch_triangles, const Progress& progress,
                                      pack::Contents& pack);

}  // namespace chandelier::baker
