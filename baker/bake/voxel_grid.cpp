// SPDX-License-Identifier: Apache-2.0
// Grids: how wide, and the cell of a point.
#include "voxel_grid.h"

#include <algorithm>
#include <cmath>

#include "../error.h"

namespace chandelier::baker {

Grid::Grid(const pack::VoxelGrid& record)
    : low(record.bounds_min_ws),
      cell_size(record.cell_size_m),
      resolution(record.resolution[0], record.resolution[1], record.resolution[2]),
      cells_per_metre(1.0 / cell_size) {
  for (int axis = 0; axis < 3; ++axis) {
    scale_m = std::max({scale_m, std::abs(low[axis]), std::abs(plane(axis, resolution[axis]))});
  }
}

int Grid::cell_of(int axis, double coordinate) const {
  int cell = about_cell_of(axis, coordinate);
  while (cell > 0 && coordinate < plane(axis, cell)) --cell;
  while (cell < resolution[axis] - 1 && coordinate >= plane(axis, cell + 1)) ++cell;
  return cell;
}

pack::VoxelGrid make_voxel_grid(const glm::vec3& bounds_min_ws, const glm::vec3& bounds_max_ws,
                                const std::array<uint32_t, 3>& resolution, pack::VoxelMode mode) {
  const glm::dvec3 low(bounds_min_ws), high(bounds_max_ws);
  const double widest = std::max({high.x - low.x, high.y - low.y, high.z - low.z});
  pack::VoxelGrid grid;
  grid.mode = mode;
  grid.resolution = resolution;
  for (int axis = 0; axis < 3; ++axis) {
    // 2⁻¹⁸ of the coordinates is some 60 times what rounding to floats below takes back; the rest is for flat scenes.
    const double scale = std::max(std::abs(low[axis]), std::abs(high[axis]));
    const double margin = std::max({widest * 1e-4, scale * 0x1p-18, 1e-6});
    const double cells = resolution[static_cast<size_t>(axis)];
    grid.bounds_min_ws[axis] = static_cast<float>(low[axis] - margin);
    grid.cell_size_m[axis] = static_cast<float>((high[axis] - low[axis] + 2 * margin) / cells);
    const double end = double{grid.bounds_min_ws[axis]} + cells * double{grid.cell_size_m[axis]};
    if (!std::isfinite(static_cast<float>(end)) || !std::isfinite(grid.bounds_min_ws[axis])) {
      fail("scene", std::string("is too wide for a voxel grid; --voxels 0 makes none (") + "xyz"[axis] + " from " +
                        to_text(low[axis]) + " to " + to_text(high[axis]) + ")");
    }
  }
  return grid;
}

uint32_t cell_at(const pack::VoxelGrid& record, const glm::vec3& position_ws) {
  const Grid grid(record);
  glm::ivec3 cell;
  for (int axis = 0; axis < 3; ++axis) {
    const double coordinate = position_ws[axis];
    if (!(coordinate >= grid.low[axis]) || !(coordinate < grid.plane(axis, grid.resolution[axis]))) return pack::none;
    cell[axis] = grid.cell_of(axis, coordinate);
  }
  return grid.number(cell);
}

}  // namespace chandelier::baker
