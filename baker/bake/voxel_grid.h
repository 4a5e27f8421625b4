// SPDX-License-Identifier: Apache-2.0
// The grid that voxel culling walks (voxel paper §4): where its planes are and which cells a point or a box touches.
#pragma once

#include <array>
#include <cstdint>
#include <glm/glm.hpp>

#include "pack_schema.h"

namespace chandelier::baker {

constexpr uint32_t most_voxels_on_axis = 1024;
constexpr uint32_t most_voxels = 1u << 24;  // in a grid: 128 MiB of records

/// A pack's grid in double precision, where cell numbers times cell sizes are exact.
struct Grid {
  glm::dvec3 low{0};
  glm::dvec3 cell_size{1};
  glm::ivec3 resolution{1};
  glm::dvec3 cells_per_metre{1};
  double scale_m = 0;  // largest coordinate of its bounds, without sign

  explicit Grid(const pack::VoxelGrid& record);

  uint32_t cell_count() const {
    return static_cast<uint32_t>(resolution.x) * static_cast<uint32_t>(resolution.y) *
           static_cast<uint32_t>(resolution.z);
  }
  /// The lower plane of the cells with number `cell` on an axis.
  double plane(int axis, int cell) const { return low[axis] + cell * cell_size[axis]; }
  uint32_t number(const glm::ivec3& cell) const {
    return static_cast<uint32_t>(cell.x + resolution.x * (cell.y + resolution.y * cell.z));
  }
  /// The cell of a point on one axis; what lies in a plane belongs to the cell above. Points outside: the nearest cell.
  int cell_of(int axis, double coordinate) const;
  /// cell_of without its last ulp: may be one off where the point is nearer than 2⁻⁴⁹ · scale_m to a plane.
  int about_cell_of(int axis, double coordinate) const {
    const double cell = (coordinate - low[axis]) * cells_per_metre[axis];
    const int last = resolution[axis] - 1;
    return cell < 0 ? 0 : cell < last ? static_cast<int>(cell) : last;
  }
};

/// A grid around a box, a little wider, so that nothing in the box touches the grid's outer faces. Axes without extent
/// get one. Throws Error where a float cannot hold the grid.
pack::VoxelGrid make_voxel_grid(const glm::vec3& bounds_min_ws, const glm::vec3& bounds_max_ws,
                                const std::array<uint32_t, 3>& resolution, pack::VoxelMode mode);

/// The number of the cell that holds a point, or pack::none outside the grid.
uint32_t cell_at(const pack::VoxelGrid& grid, const glm::vec3& position_ws);

}  // namespace chandelier::baker
