// SPDX-License-Identifier: Apache-2.0
// Blocks of batch instances become pieces in parallel; pieces sorted by cell become runs; runs are filled in parallel.
#include "voxel_bins.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <span>
#include <string>

#include "../error.h"
#include "clip.h"
#include "is_static.h"
#include "throws_shadow.h"
#include "voxel_grid.h"
#include "voxel_pieces.h"

namespace chandelier::baker {
namespace {

constexpr size_t block_size = 64;  // batch instances: some thousand triangles

/// The grid around the static batch instances; none where there are none.
std::vector<pack::VoxelGrid> grid_of(const VoxelSettings& settings, const pack::Contents& pack) {
  bool any = false;
  glm::vec3 low(0), high(0);
  for (const pack::BatchInstance& record : pack.batch_instances) {
    if (!is_static(pack, record)) continue;
    low = any ? glm::min(low, record.bounds_min_ws) : record.bounds_min_ws;
    high = any ? glm::max(high, record.bounds_max_ws) : record.bounds_max_ws;
    any = true;
  }
  if (!any) return {};
  return {make_voxel_grid(low, high, settings.resolution, settings.mode)};
}

std::vector<VoxelBlock> make_blocks(const pack::Contents& pack, const Grid& grid, pack::VoxelMode mode) {
  const size_t count = pack.batch_instances.size();
  std::vector<VoxelBlock> blocks((count + block_size - 1) / block_size);
  std::atomic<uint64_t> clipped_triangles = 0;
  tbb::parallel_for(size_t{0}, blocks.size(), [&](size_t b) {
    for (size_t i = b * block_size; i < std::min(count, (b + 1) * block_size); ++i) {
      const pack::BatchInstance& record = pack.batch_instances[i];
      if (!is_static(pack, record) || !pack::throws_shadow(pack, record)) continue;
      const PlacedBatch placed(pack, static_cast<uint32_t>(i));
      if (mode == pack::VoxelMode::clip) {
        bin_clipped(placed, grid, clipped_triangles, blocks[b]);
      } else {
        bin_separate(placed, grid, blocks[b]);
      }
    }
    for (VoxelPiece& piece : blocks[b].pieces) piece.block = static_cast<uint32_t>(b);
  });
  return blocks;
}

/// All pieces, cell after cell, in each in the order of batch instances.
struct SortedPieces {
  std::vector<VoxelPiece> pieces;
  std::vector<uint32_t> first_piece;     // of each cell, of no cell, and the end
  std::vector<uint32_t> first_triangle;  // of each piece, in voxel_indices
  uint64_t triangle_count = 0;
};

SortedPieces sort_pieces(std::vector<VoxelBlock>& blocks, uint32_t cell_count) {
  SortedPieces out;
  uint64_t count = 0;
  for (const VoxelBlock& block : blocks) count += block.pieces.size();
  fit_u32(count, "voxel runs");
  out.first_piece.resize(size_t{cell_count} + 2);
  for (const VoxelBlock& block : blocks) {
    for (const VoxelPiece& piece : block.pieces) ++out.first_piece[piece.cell + 1];
  }
  for (size_t cell = 0; cell <= cell_count; ++cell) out.first_piece[cell + 1] += out.first_piece[cell];
  out.pieces.resize(count);
  std::vector<uint32_t> next = out.first_piece;
  for (VoxelBlock& block : blocks) {
    for (const VoxelPiece& piece : block.pieces) out.pieces[next[piece.cell]++] = piece;
    block.pieces = {};
  }
  for (const VoxelPiece& piece : out.pieces) {
    out.first_triangle.push_back(static_cast<uint32_t>(out.triangle_count));
    out.triangle_count += piece.triangle_count;
    fit_u32(3 * out.triangle_count, "triangle corners in voxels");
  }
  return out;
}

/// Appends the runs of pieces in a row: one while instance and material stay.
void append_runs(std::span<const VoxelPiece> pieces, bool clipped, pack::Contents& pack, uint32_t& next_index) {
  const size_t first_run = pack.voxel_runs.size();
  for (const VoxelPiece& piece : pieces) {
    const pack::BatchInstance& record = pack.batch_instances[piece.batch_instance];
    const uint32_t instance = clipped ? pack::none : record.instance;
    const uint32_t material = pack.batches[record.batch].material;
    if (pack.voxel_runs.size() == first_run || pack.voxel_runs.back().instance != instance ||
        pack.voxel_runs.back().material != material) {
      pack.voxel_runs.push_back({instance, material, next_index, 0});
    }
    pack.voxel_runs.back().index_count += 3 * piece.triangle_count;
    next_index += 3 * piece.triangle_count;
  }
}

void make_cells(const SortedPieces& sorted, uint32_t cell_count, pack::Contents& pack) {
  const bool clipped = pack.voxel_grid[0].mode == pack::VoxelMode::clip;
  pack.voxel_cells.resize(cell_count);
  pack.voxel_occupancy.resize((size_t{cell_count} + 31) / 32);
  uint32_t next_index = 0;
  for (uint32_t cell = 0; cell <= cell_count; ++cell) {
    const std::span pieces =
        std::span(sorted.pieces)
            .subspan(sorted.first_piece[cell], sorted.first_piece[cell + 1] - sorted.first_piece[cell]);
    const auto first_run = static_cast<uint32_t>(pack.voxel_runs.size());
    append_runs(pieces, clipped, pack, next_index);
    const uint32_t run_count = static_cast<uint32_t>(pack.voxel_runs.size()) - first_run;
    if (cell == cell_count) {
      pack.voxel_grid[0].no_cull_first_run = first_run;
      pack.voxel_grid[0].no_cull_run_count = run_count;
    } else {
      pack.voxel_cells[cell] = {first_run, run_count};
      if (run_count) pack.voxel_occupancy[cell / 32].bits |= 1u << cell % 32;
    }
  }
}

void fill_separate(const SortedPieces& sorted, const std::vector<VoxelBlock>& blocks, pack::Contents& pack) {
  tbb::parallel_for(size_t{0}, sorted.pieces.size(), [&](size_t p) {
    const VoxelPiece& piece = sorted.pieces[p];
    const PlacedBatch placed(pack, piece.batch_instance);
    pack::VoxelIndex* out = &pack.voxel_indices[size_t{3} * sorted.first_triangle[p]];
    for (uint32_t i = 0; i < piece.triangle_count; ++i) {
      const uint32_t triangle =
          piece.first_number == pack::none ? i : blocks[piece.block].numbers[piece.first_number + i];
      for (uint32_t corner = 0; corner < 3; ++corner) *out++ = {placed.vertex(triangle, corner)};
    }
  });
}

/// Vertices of one cell, equal ones once; voxel_indices of the cell then count from the cell's first vertex.
std::vector<pack::VoxelVertex> weld_cell(const SortedPieces& sorted, const std::vector<VoxelBlock>& blocks, size_t cell,
                                         pack::Contents& pack) {
  size_t most = 0;
  for (size_t p = sorted.first_piece[cell]; p < sorted.first_piece[cell + 1]; ++p) {
    most += sorted.pieces[p].vertex_count;
  }
  UniqueVertices unique;
  unique.reset(most);
  std::vector<uint32_t> numbers;  // of the piece's vertices in the cell
  for (size_t p = sorted.first_piece[cell]; p < sorted.first_piece[cell + 1]; ++p) {
    const VoxelPiece& piece = sorted.pieces[p];
    const VoxelBlock& block = blocks[piece.block];
    numbers.clear();
    for (uint32_t v = 0; v < piece.vertex_count; ++v) {
      numbers.push_back(unique.add(block.vertices[piece.first_vertex + v]));
    }
    pack::VoxelIndex* out = &pack.voxel_indices[size_t{3} * sorted.first_triangle[p]];
    for (size_t i = 0; i < size_t{3} * piece.triangle_count; ++i) {
      *out++ = {numbers[block.numbers[piece.first_number + i]]};
    }
  }
  return unique.vertices();
}

void fill_clipped(const SortedPieces& sorted, const std::vector<VoxelBlock>& blocks, pack::Contents& pack) {
  const size_t cell_count = pack.voxel_cells.size();
  std::vector<std::vector<pack::VoxelVertex>> vertices(cell_count);
  tbb::parallel_for(size_t{0}, cell_count, [&](size_t cell) {
    if (pack.voxel_cells[cell].run_count) vertices[cell] = weld_cell(sorted, blocks, cell, pack);
  });
  std::vector<uint32_t> first_vertex(cell_count + 1);
  for (size_t cell = 0; cell < cell_count; ++cell) {
    first_vertex[cell + 1] = fit_u32(uint64_t{first_vertex[cell]} + vertices[cell].size(), "vertices in voxels");
  }
  pack.voxel_vertices.resize(first_vertex[cell_count]);
  tbb::parallel_for(size_t{0}, cell_count, [&](size_t cell) {
    std::copy(vertices[cell].begin(), vertices[cell].end(), pack.voxel_vertices.begin() + first_vertex[cell]);
    for (uint32_t r = 0; r < pack.voxel_cells[cell].run_count; ++r) {
      const pack::VoxelRun& run = pack.voxel_runs[pack.voxel_cells[cell].first_run + r];
      for (uint32_t i = 0; i < run.index_count; ++i) {
        pack.voxel_indices[run.first_index + i].vertex += first_vertex[cell];
      }
    }
    vertices[cell] = {};
  });
}

void count_voxels(const pack::Contents& pack, const std::vector<VoxelBlock>& blocks, PassReport& pass) {
  uint64_t occupied = 0, no_cull = 0;
  for (const pack::VoxelCell& cell : pack.voxel_cells) occupied += cell.run_count != 0;
  const pack::VoxelGrid& grid = pack.voxel_grid[0];
  for (uint32_t r = 0; r < grid.no_cull_run_count; ++r) {
    no_cull += pack.voxel_runs[grid.no_cull_first_run + r].index_count / 3;
  }
  pass.bytes = sizeof(grid) + std::span(pack.voxel_cells).size_bytes() + std::span(pack.voxel_runs).size_bytes() +
               std::span(pack.voxel_indices).size_bytes() + std::span(pack.voxel_vertices).size_bytes() +
               std::span(pack.voxel_occupancy).size_bytes();
  pass.count("cells", static_cast<double>(pack.voxel_cells.size()));
  pass.count("occupied_cells", static_cast<double>(occupied));
  pass.count("runs", static_cast<double>(pack.voxel_runs.size()));
  pass.count("triangles", static_cast<double>(pack.voxel_indices.size() / 3));
  pass.count("no_cull_triangles", static_cast<double>(no_cull));
  if (grid.mode != pack::VoxelMode::clip) return;
  double input = 0, clipped = 0;
  for (const VoxelBlock& block : blocks) {
    input += block.input_area_m2;
    clipped += block.clipped_area_m2;
  }
  pass.count("clipped_area_error", input > 0 ? std::abs(clipped - input) / input : 0);
}

}  // namespace

void make_voxels(const VoxelSettings& settings, const Progress& progress, pack::Contents& pack, PassReport& pass) {
  if (settings.resolution[0] == 0) return;
  pack.voxel_grid = grid_of(settings, pack);
  if (pack.voxel_grid.empty()) return;
  const Grid grid(pack.voxel_grid[0]);
  progress.next("sorting " + std::to_string(pack.batch_instances.size()) + " batches into voxels");
  std::vector<VoxelBlock> blocks = make_blocks(pack, grid, settings.mode);
  const SortedPieces sorted = sort_pieces(blocks, grid.cell_count());
  make_cells(sorted, grid.cell_count(), pack);
  pack.voxel_indices.resize(3 * sorted.triangle_count);
  if (settings.mode == pack::VoxelMode::clip) {
    fill_clipped(sorted, blocks, pack);
  } else {
    fill_separate(sorted, blocks, pack);
  }
  count_voxels(pack, blocks, pass);
}

}  // namespace chandelier::baker
