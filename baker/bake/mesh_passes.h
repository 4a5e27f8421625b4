// SPDX-License-Identifier: Apache-2.0
// The passes that turn the scene's meshes into the pack's, in their order.
#pragma once

#include "../report.h"
#include "bake.h"
#include "batches.h"

namespace chandelier::baker {

/// Takes the meshes' vertices out of the scene, and fills the pack's vertices, indices, batches and meshes. Throws
/// Error.
std::vector<MeshRecords> bake_meshes(Scene& scene, const BakeSettings& settings, Report& report, pack::Contents& pack);

}  // namespace chandelier::baker
