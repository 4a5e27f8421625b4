// SPDX-License-Identifier: Apache-2.0
// Cuts triangles at the faces of a grid's cells (Sutherland and Hodgman 1974), so that every point of a piece is in one
// cell.
#pragma once

#include <algorithm>
#include <array>
#include <atomic>
#include <cstdint>
#include <glm/glm.hpp>
#include <utility>
#include <vector>

#include "pack_schema.h"
#include "voxel_grid.h"
#include "voxel_pieces.h"

namespace chandelier::baker {

struct ClipVertex {
  glm::dvec3 position{0};
  glm::dvec2 uv{0};
};
using ClipPolygon = std::vector<ClipVertex>;  // convex

/// Splits a polygon in two at a plane that crosses it; corners in the plane come into both.
void split(const ClipPolygon& polygon, int axis, double plane, ClipPolygon& below, ClipPolygon& above);

/// Cuts triangles at the borders of cells; reuses its memory for the next triangle.
class Clipper {
 public:
  explicit Clipper(const Grid& grid) : grid_(grid) {}

  /// Calls emit(cell, polygon) for each cell that holds a part of the triangle. Cells are half open: a polygon in the
  /// plane between two cells is in the upper one alone. The border of a part in the lower cell stays there.
  template <typename Emit>
  void cut(const std::array<ClipVertex, 3>& triangle, Emit emit) {
    parts_[0].assign(triangle.begin(), triangle.end());
    cut_axis(0, emit);
  }

 private:
  template <typename Emit>
  void cut_axis(int axis, Emit& emit) {
    if (axis == 3) {
      emit(grid_.number(cell_), std::as_const(parts_[3]));
      return;
    }
    ClipPolygon &rest = parts_[static_cast<size_t>(axis)], &part = parts_[static_cast<size_t>(axis) + 1];
    double low = rest[0].position[axis], high = low;
    for (const ClipVertex& vertex : rest) {
      low = std::min(low, vertex.position[axis]);
      high = std::max(high, vertex.position[axis]);
    }
    cell_[axis] = grid_.cell_of(axis, low);
    for (; cell_[axis] + 1 < grid_.resolution[axis]; ++cell_[axis]) {
      const double plane = grid_.plane(axis, cell_[axis] + 1);
      if (high <= plane) break;
      split(rest, axis, plane, part, above_);
      rest.swap(above_);
      cut_axis(axis + 1, emit);
    }
    part.swap(rest);
    cut_axis(axis + 1, emit);
  }

  const Grid& grid_;
  glm::ivec3 cell_{0};
  std::array<ClipPolygon, 4> parts_;  // to be cut along x, y and z; the last is finished
  ClipPolygon above_;
};

/// Distinct vertices, in the order of their first occurrence.
class UniqueVertices {
 public:
  /// Removes all vertices and makes room for this many.
  void reset(size_t most_vertices);
  /// Returns the number of the equal vertex; appends `vertex` if there is none.
  uint32_t add(const pack::VoxelVertex& vertex);
  const std::vector<pack::VoxelVertex>& vertices() const { return vertices_; }

 private:
  std::vector<pack::VoxelVertex> vertices_;
  std::vector<uint32_t> slots_;  // open addressing: numbers of vertices; a power of two, at most half full
};

constexpr uint64_t most_clipped_triangles = uint64_t{1} << 28;

/// Appends a batch's triangles to `block`, cut to cells, each piece with vertices of its own. `total` counts the
/// triangles of all blocks. Throws Error where they become more than most_clipped_triangles.
void bin_clipped(const PlacedBatch& placed, const Grid& grid, std::atomic<uint64_t>& total, VoxelBlock& block);

}  // namespace chandelier::baker
