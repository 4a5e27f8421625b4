// SPDX-License-Identifier: Apache-2.0
// Which cells of a pack's voxel grid hold triangles, and whether one of them lies on a way.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "pack_schema.h"

namespace chandelier::lights {

class Occupancy {
 public:
  /// Empty for a pack without voxels. The pack's own bits, and the cells of the triangles that are too large for its
  /// cells (VoxelMode separate): those are the walls.
  explicit Occupancy(const pack::View& pack);

  bool is_occupied(const glm::ivec3& cell) const;
  /// A cell with triangles lies on the straight way, and neither point is in it.
  bool between(const glm::vec3& a_ws, const glm::vec3& b_ws) const;

 private:
  void add_large_triangles(const pack::View& pack);
  void add(const glm::dvec3 (&corners)[3]);  // in cells

  glm::dvec3 low_ws_{0.0};
  glm::dvec3 cell_size_m_{1.0};
  glm::ivec3 resolution_{0};
  std::vector<uint32_t> bits_;  // as voxel_occupancy
};

}  // namespace chandelier::lights
