// SPDX-License-Identifier: Apache-2.0
// The rules between fields of the voxel sections.
#include "pack_checks_voxels.h"

#include <algorithm>
#include <cmath>

#include "pack_checks_text.h"

namespace chandelier::pack {
namespace {

std::string no_grid_fault(const View& view) {
  const auto fault = [](const char* section, size_t count) {
    return std::string(section) + ": " + text(count) + " records without a voxel_grid";
  };
  if (!view.voxel_cells.empty()) return fault("voxel_cells", view.voxel_cells.size());
  if (!view.voxel_runs.empty()) return fault("voxel_runs", view.voxel_runs.size());
  if (!view.voxel_indices.empty()) return fault("voxel_indices", view.voxel_indices.size());
  if (!view.voxel_vertices.empty()) return fault("voxel_vertices", view.voxel_vertices.size());
  if (!view.voxel_occupancy.empty()) return fault("voxel_occupancy", view.voxel_occupancy.size());
  return {};
}

/// The upper end of the grid along an axis.
double grid_end(const VoxelGrid& grid, int axis) {
  return double{grid.bounds_min_ws[axis]} + double{grid.cell_size_m[axis]} * grid.resolution[static_cast<size_t>(axis)];
}

std::string grid_fault(const View& view) {
  const VoxelGrid& grid = view.voxel_grid[0];
  for (int axis = 0; axis < 3; ++axis) {
    const std::string place = std::string("voxel_grid[0].cell_size_m.") + "xyz"[axis] + ": ";
    if (!(grid.cell_size_m[axis] > 0)) return place + text(grid.cell_size_m[axis]) + " is not above 0";
    if (!std::isfinite(static_cast<float>(grid_end(grid, axis)))) {
      return place + text(grid.cell_size_m[axis]) + " makes the grid end beyond a float";
    }
  }
  const uint64_t cells = uint64_t{grid.resolution[0]} * grid.resolution[1] * grid.resolution[2];
  if (view.voxel_cells.size() != cells) {
    return "voxel_cells: " + text(view.voxel_cells.size()) + " records for a resolution of " + text(cells) + " cells";
  }
  if (view.voxel_occupancy.size() != (cells + 31) / 32) {
    return "voxel_occupancy: " + text(view.voxel_occupancy.size()) + " records for " + text(cells) + " cells";
  }
  return {};
}

/// Every static triangle is inside: what lies outside would be in no cell.
std::string extent_fault(const View& view) {
  const VoxelGrid& grid = view.voxel_grid[0];
  for (size_t i = 0; i < view.batch_instances.size(); ++i) {
    const BatchInstance& record = view.batch_instances[i];
    if (view.instances[record.instance].dynamic) continue;
    for (int axis = 0; axis < 3; ++axis) {
      if (record.bounds_min_ws[axis] < grid.bounds_min_ws[axis]) {
        return at("batch_instances", i) + ".bounds_min_ws." + "xyz"[axis] + ": " + text(record.bounds_min_ws[axis]) +
               " is below the voxel grid's " + text(grid.bounds_min_ws[axis]);
      }
      if (record.bounds_max_ws[axis] > grid_end(grid, axis)) {
        return at("batch_instances", i) + ".bounds_max_ws." + "xyz"[axis] + ": " + text(record.bounds_max_ws[axis]) +
               " is above the voxel grid's " + text(static_cast<float>(grid_end(grid, axis)));
      }
    }
  }
  return {};
}

/// Cells in their order, then what is always drawn: each run belongs to one of them.
std::string cells_fault(const View& view) {
  const VoxelGrid& grid = view.voxel_grid[0];
  uint64_t next = 0;
  for (size_t i = 0; i < view.voxel_cells.size(); ++i) {
    const VoxelCell& cell = view.voxel_cells[i];
    if (cell.first_run != next) {
      return at("voxel_cells", i) + ".first_run: " + text(uint64_t{cell.first_run}) +
             " where the cell before ends at " + text(next);
    }
    next += cell.run_count;
    const bool bit = (view.voxel_occupancy[i / 32].bits >> i % 32 & 1) != 0;
    if (bit != (cell.run_count != 0)) {
      return at("voxel_occupancy", i / 32) + ".bits: bit " + text(i % 32) + " is " + text(uint64_t{bit}) +
             " where the cell has " + text(uint64_t{cell.run_count}) + " runs";
    }
  }
  if (const size_t rest = view.voxel_cells.size() % 32; rest && view.voxel_occupancy.back().bits >> rest) {
    return at("voxel_occupancy", view.voxel_occupancy.size() - 1) + ".bits: bits past the last cell are set";
  }
  if (grid.no_cull_first_run != next) {
    return "voxel_grid[0].no_cull_first_run: " + text(uint64_t{grid.no_cull_first_run}) +
           " where the last cell ends at " + text(next);
  }
  next += grid.no_cull_run_count;
  if (next == view.voxel_runs.size()) return {};
  return "voxel_runs: " + text(view.voxel_runs.size()) + " records where cells and no_cull_run_count have " +
         text(next);
}

std::string indices_fault(const View& view, const VoxelRun& run) {
  const bool clipped = run.instance == none;
  const size_t count = clipped ? view.voxel_vertices.size() : view.positions.size();
  uint32_t most = 0;
  for (const VoxelIndex& index : view.voxel_indices.subspan(run.first_index, run.index_count)) {
    most = std::max(most, index.vertex);
  }
  if (most < count) return {};
  for (size_t i = run.first_index; i < size_t{run.first_index} + run.index_count; ++i) {
    if (view.voxel_indices[i].vertex < count) continue;
    return at("voxel_indices", i) + ".vertex: " + text(uint64_t{view.voxel_indices[i].vertex}) + " is not below the " +
           text(count) + (clipped ? " voxel_vertices" : " positions");
  }
  return {};
}

std::string runs_fault(const View& view) {
  const bool separate = view.voxel_grid[0].mode == VoxelMode::separate;
  uint64_t next = 0;
  for (size_t i = 0; i < view.voxel_runs.size(); ++i) {
    const VoxelRun& run = view.voxel_runs[i];
    if (run.first_index != next) {
      return at("voxel_runs", i) + ".first_index: " + text(uint64_t{run.first_index}) +
             " where the run before ends at " + text(next);
    }
    if (run.index_count % 3 != 0) {
      return at("voxel_runs", i) + ".index_count: " + text(uint64_t{run.index_count}) + " is not a multiple of 3";
    }
    next += run.index_count;
    if (run.instance == none && separate) return at("voxel_runs", i) + ".instance: none where nothing is clipped";
    if (run.instance != none && view.instances[run.instance].dynamic) {
      return at("voxel_runs", i) + ".instance: " + text(uint64_t{run.instance}) + " is dynamic";
    }
    if (std::string line = indices_fault(view, run); !line.empty()) return line;
  }
  if (next == view.voxel_indices.size()) return {};
  return "voxel_indices: " + text(view.voxel_indices.size()) + " records where the runs have " + text(next);
}

}  // namespace

std::string voxel_fault(const View& view) {
  if (view.voxel_grid.empty()) return no_grid_fault(view);
  if (std::string line = grid_fault(view); !line.empty()) return line;
  if (std::string line = extent_fault(view); !line.empty()) return line;
  if (std::string line = cells_fault(view); !line.empty()) return line;
  return runs_fault(view);
}

}  // namespace chandelier::pack
