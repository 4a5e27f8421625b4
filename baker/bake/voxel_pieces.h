// SPDX-License-Identifier: Apache-2.0
// The pieces of voxel bins: the triangles of one batch instance in one cell.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "pack_schema.h"
#include "triangle_box.h"
#include "voxel_grid.h"

namespace chandelier::baker {

struct VoxelPiece {
  uint32_t cell = 0;  // the grid's number of cells: in no cell, always drawn
  uint32_t batch_instance = 0;
  uint32_t triangle_count = 0;
  uint32_t block = 0;         // the block that holds the arrays for the numbers below
  uint32_t first_number = 0;  // pack::none: the whole batch
  uint32_t first_vertex = 0;  // clipped only
  uint32_t vertex_count = 0;
};

/// The pieces of consecutive batch instances. A thread works on one block at a time.
struct VoxelBlock {
  std::vector<VoxelPiece> pieces;
  std::vector<uint16_t> numbers;            // separate: triangles of the batch; clipped: corners, from first_vertex on
  std::vector<pack::VoxelVertex> vertices;  // clipped only
  double input_area_m2 = 0;                 // clipped only
  double clipped_area_m2 = 0;
};

/// A batch in its place, in double precision.
class PlacedBatch {
 public:
  PlacedBatch(const pack::Contents& pack, uint32_t batch_instance);

  const pack::Contents& pack;
  const uint32_t batch_instance;
  const pack::Batch& batch;
  const pack::Instance& instance;

  uint32_t triangle_count() const { return batch.index_count / 3; }
  uint32_t vertex(uint32_t triangle, uint32_t corner) const {
    return pack.indices[batch.first_index + 3 * triangle + corner].vertex;
  }
  Triangle triangle_ws(uint32_t triangle) const {
    return {corner_ws(triangle, 0), corner_ws(triangle, 1), corner_ws(triangle, 2)};
  }
  /// An upper bound, along each axis, of the rounding errors of triangle_ws's corners and of the planes by which Grid's
  /// about_cell_of decides: 2⁻⁴⁷ times the largest number that goes into either.
  double slack_m(const Grid& grid) const;

 private:
  glm::dvec3 corner_ws(uint32_t triangle, uint32_t corner) const {
    const glm::dvec3 p(pack.positions[vertex(triangle, corner)].position_ls);
    return x_ * p.x + y_ * p.y + z_ * p.z + origin_;
  }
  glm::dvec3 x_, y_, z_, origin_;  // columns of world_from_local
};

/// Appends a batch's triangles to `block`: for each cell that a triangle overlaps if they are at most two, else for no
/// cell.
void bin_separate(const PlacedBatch& placed, const Grid& grid, VoxelBlock& block);

}  // namespace chandelier::baker
