// SPDX-License-Identifier: Apache-2.0
// Pass: meshes into batches of about a hundred neighbouring triangles.
#pragma once

#include "../progress.h"
#include "../scene.h"
#include "pack_schema.h"

namespace chandelier::baker {

/// Numbers of a scene mesh's records among the pack's meshes, as modelled and with its triangles' winding reversed; kNone
/// where it has no triangles or no instance needs it.
struct MeshRecords {
  std::uint32_t plain = kNone;
  std::uint32_t mirrored = kNone;
};

bool is_mirrored(const MeshInstance& instance);

/// Fills positions, vertex_attributes, indices, batches and meshes; takes the meshes' vertices out of the scene. The result
/// does not depend on the number of threads. Throws Error.
std::vector<MeshRecords> make_batches(Scene& scene, std::uint32_t batch_triangles, const Progress& progress,
                                      pack::Contents& pack);

}  // namespace chandelier::baker
