// SPDX-License-Identifier: Apache-2.0
// Pass: sorts the static triangles into the cells of a grid, for culling along lines of cells (voxel paper §4).
#pragma once

#include <array>
#include <cstdint>

#include "../progress.h"
#include "../report.h"
#include "pack_schema.h"

namespace chandelier::baker {

struct VoxelSettings {
  std::array<uint32_t, 3> resolution = {32, 32, 32};  // cells along x, y, z; all zero: no grid
  pack::VoxelMode mode = pack::VoxelMode::separate;
};

/// Fills voxel_grid, voxel_cells, voxel_runs, voxel_indices, voxel_vertices and voxel_occupancy, where there is a
/// static triangle; needs batch_instances and materials. In a cell, runs are in the order of batch_instances. The
/// result does not depend on the number of threads. Throws Error.
void make_voxels(const VoxelSettings& settings, const Progress& progress, pack::Contents& pack, PassReport& pass);

}  // namespace chandelier::baker
