// SPDX-License-Identifier: Apache-2.0
// Which cells the triangles of a batch overlap; none is missed, for all boxes are compared with slack for rounding.
#include "voxel_pieces.h"

#include <algorithm>

namespace chandelier::baker {
namespace {

constexpr int most_cells = 2;  // of a triangle that is not always drawn (voxel paper §4)

struct CellRange {
  glm::ivec3 low, high;  // both included

  glm::ivec3 size() const { return high - low + 1; }
  bool one() const { return low == high; }
};

/// All cells that touch a box or come within `slack` of it.
CellRange cells_of(const Grid& grid, const glm::dvec3& box_min, const glm::dvec3& box_max, double slack) {
  CellRange range;
  for (int axis = 0; axis < 3; ++axis) {
    range.low[axis] = grid.about_cell_of(axis, box_min[axis] - slack);
    range.high[axis] = grid.about_cell_of(axis, box_max[axis] + slack);
  }
  return range;
}

/// The cells that a triangle overlaps, or most_cells + 1 where they are more.
struct Overlaps {
  std::array<uint32_t, most_cells> cells{};
  int count = 0;
};

void test_cells(const Triangle& triangle, const Grid& grid, const CellRange& range, double slack, Overlaps& out) {
  glm::ivec3 cell;
  for (cell.z = range.low.z; cell.z <= range.high.z; ++cell.z) {
    for (cell.y = range.low.y; cell.y <= range.high.y; ++cell.y) {
      for (cell.x = range.low.x; cell.x <= range.high.x; ++cell.x) {
        const glm::dvec3 low(grid.plane(0, cell.x), grid.plane(1, cell.y), grid.plane(2, cell.z));
        const glm::dvec3 high(grid.plane(0, cell.x + 1), grid.plane(1, cell.y + 1), grid.plane(2, cell.z + 1));
        if (!may_overlap(triangle, low, high, slack)) continue;
        if (out.count == most_cells) {
          out.count = most_cells + 1;
          return;
        }
        out.cells[static_cast<size_t>(out.count++)] = grid.number(cell);
      }
    }
  }
}

Overlaps overlaps_of(const Triangle& triangle, const Grid& grid, double slack) {
  const glm::dvec3 low = glm::min(glm::min(triangle[0], triangle[1]), triangle[2]);
  const glm::dvec3 high = glm::max(glm::max(triangle[0], triangle[1]), triangle[2]);
  const CellRange range = cells_of(grid, low, high, slack);
  const glm::ivec3 size = range.size();
  Overlaps out;
  if (std::max({size.x, size.y, size.z}) > most_cells) {  // a triangle is connected, so it has a point in each layer
    out.count = most_cells + 1;
  } else if (size.x * size.y * size.z <= most_cells) {  // likewise: it has a point in both cells
    out.cells = {grid.number(range.low), grid.number(range.high)};
    out.count = size.x * size.y * size.z;
  } else {
    test_cells(triangle, grid, range, slack, out);
  }
  return out;
}

}  // namespace

PlacedBatch::PlacedBatch(const pack::Contents& contents, uint32_t number)
    : pack(contents),
      batch_instance(number),
      batch(contents.batches[contents.batch_instances[number].batch]),
      instance(contents.instances[contents.batch_instances[number].instance]) {
  for (int row = 0; row < 3; ++row) {
    const glm::dvec4 values(instance.world_from_local[static_cast<size_t>(row)]);
    x_[row] = values.x, y_[row] = values.y, z_[row] = values.z, origin_[row] = values.w;
  }
}

// A corner is the sum of three products, exact in double, and a number: three roundings of at most 2⁻⁵³ of the sum of
// their sizes. about_cell_of rounds three times: a difference, a reciprocal, a product, so by less than 2⁻⁵³ · 6 of the
// grid's coordinates; a plane rounds once. may_overlap's own needs are 2⁻⁴⁸ of both. All of it is below 2⁻⁴⁷.
double PlacedBatch::slack_m(const Grid& grid) const {
  const glm::dvec3 far(glm::max(glm::abs(batch.bounds_min_ls), glm::abs(batch.bounds_max_ls)));
  const glm::dvec3 sum = glm::abs(x_) * far.x + glm::abs(y_) * far.y + glm::abs(z_) * far.z + glm::abs(origin_);
  return 0x1p-47 * (std::max({sum.x, sum.y, sum.z}) + grid.scale_m);
}

void bin_separate(const PlacedBatch& placed, const Grid& grid, VoxelBlock& block) {
  const pack::BatchInstance& record = placed.pack.batch_instances[placed.batch_instance];
  const double slack = placed.slack_m(grid);
  const CellRange around = cells_of(grid, record.bounds_min_ws, record.bounds_max_ws, slack);
  VoxelPiece piece{.batch_instance = placed.batch_instance};
  if (around.one()) {
    piece.cell = grid.number(around.low);
    piece.triangle_count = placed.triangle_count();
    piece.first_number = pack::none;
    block.pieces.push_back(piece);
    return;
  }
  thread_local std::vector<uint64_t> entries;  // cell and triangle, to be sorted
  entries.clear();
  for (uint32_t t = 0; t < placed.triangle_count(); ++t) {
    const Overlaps overlaps = overlaps_of(placed.triangle_ws(t), grid, slack);
    if (overlaps.count > most_cells) entries.push_back(uint64_t{grid.cell_count()} << 32 | t);
    for (int i = 0; i < overlaps.count && overlaps.count <= most_cells; ++i) {
      entries.push_back(uint64_t{overlaps.cells[static_cast<size_t>(i)]} << 32 | t);
    }
  }
  std::sort(entries.begin(), entries.end());
  for (size_t i = 0; i < entries.size();) {
    piece.cell = static_cast<uint32_t>(entries[i] >> 32);
    piece.first_number = static_cast<uint32_t>(block.numbers.size());
    for (; i < entries.size() && entries[i] >> 32 == piece.cell; ++i) {
      block.numbers.push_back(static_cast<uint16_t>(entries[i]));
    }
    piece.triangle_count = static_cast<uint32_t>(block.numbers.size()) - piece.first_number;
    block.pieces.push_back(piece);
  }
}

}  // namespace chandelier::baker
