// SPDX-License-Identifier: Apache-2.0
// Voxel sections that break a rule: opening names the record. The sample has two cells, and in clip mode runs of both
// kinds.
#include <gtest/gtest.h>

#include <limits>

#include "pack_breach.h"

namespace chandelier::pack::test {
namespace {

/// Without a grid, and with nothing else that needs one.
void drop_grid(Contents& c) {
  c.voxel_grid.clear(), c.voxel_cells.clear(), c.voxel_runs.clear();
  c.voxel_indices.clear(), c.voxel_vertices.clear(), c.voxel_occupancy.clear();
  for (Light& light : c.lights) light.voxel = none;
}

const Breach breaches[] = {
    {"CellsWithoutAGrid", [](Contents& c) { drop_grid(c), c.voxel_cells.resize(2); },
     "voxel_cells: 2 records without a voxel_grid"},
    {"RunsWithoutAGrid",
     [](Contents& c) {
       drop_grid(c), c.voxel_indices.resize(3), c.voxel_runs = {{none, 0, 0, 3}};
     },
     "voxel_runs: 1 records without a voxel_grid"},
    {"IndicesWithoutAGrid", [](Contents& c) { drop_grid(c), c.voxel_indices.resize(3); },
     "voxel_indices: 3 records without a voxel_grid"},
    {"VerticesWithoutAGrid", [](Contents& c) { drop_grid(c), c.voxel_vertices.resize(4); },
     "voxel_vertices: 4 records without a voxel_grid"},
    {"OccupancyWithoutAGrid", [](Contents& c) { drop_grid(c), c.voxel_occupancy.resize(1); },
     "voxel_occupancy: 1 records without a voxel_grid"},
    {"NoCellSize", [](Contents& c) { c.voxel_grid[0].cell_size_m.y = 0; },
     "voxel_grid[0].cell_size_m.y: 0 is not above 0"},
    {"EndlessGrid", [](Contents& c) { c.voxel_grid[0].cell_size_m.z = 3e38f; },
     "voxel_grid[0].cell_size_m.z: 3e+38 makes the grid end beyond a float"},
    {"Resolution", [](Contents& c) { c.voxel_grid[0].resolution[0] = 3; },
     "voxel_cells: 2 records for a resolution of 6 cells"},
    {"LargestResolution",
     [](Contents& c) {
       c.voxel_grid[0].resolution = {1024, 1024, 1024};
     },
     "voxel_cells: 2 records for a resolution of 1073741824 cells"},
    {"OccupancyWords", [](Contents& c) { c.voxel_occupancy.push_back({0}); }, "voxel_occupancy: 2 records for 2 cells"},
    {"TrianglesBelowTheGrid", [](Contents& c) { c.voxel_grid[0].bounds_min_ws.x = -1.5f; },
     "batch_instances[0].bounds_min_ws.x: -2 is below the voxel grid's -1.5"},
    {"TrianglesAboveTheGrid", [](Contents& c) { c.voxel_grid[0].cell_size_m.y = 0.5f; },
     "batch_instances[0].bounds_max_ws.y: 1 is above the voxel grid's 0.5"},
    {"CellOverlapsTheOneBefore",
     [](Contents& c) {
       c.voxel_cells[1] = {0, 4};
     },
     "voxel_cells[1].first_run: 0 where the cell before ends at 1"},
    {"CellLeavesAGap",
     [](Contents& c) {
       c.voxel_cells[0] = {0, 0}, c.voxel_occupancy[0].bits = 2;
     },
     "voxel_cells[1].first_run: 1 where the cell before ends at 0"},
    {"MissingBit", [](Contents& c) { c.voxel_occupancy[0].bits = 1; },
     "voxel_occupancy[0].bits: bit 1 is 0 where the cell has 3 runs"},
    {"WrongBit",
     [](Contents& c) {
       c.voxel_cells = {{0, 0}, {0, 4}};
     },
     "voxel_occupancy[0].bits: bit 0 is 1 where the cell has 0 runs"},
    {"BitOfNoCell", [](Contents& c) { c.voxel_occupancy[0].bits = 7; },
     "voxel_occupancy[0].bits: bits past the last cell are set"},
    {"AlwaysDrawnBeforeTheCellsEnd", [](Contents& c) { c.voxel_grid[0].no_cull_first_run = 3; },
     "voxel_grid[0].no_cull_first_run: 3 where the last cell ends at 4"},
    {"RunOfNoCell", [](Contents& c) { c.voxel_cells[1].run_count = 2, c.voxel_grid[0].no_cull_first_run = 3; },
     "voxel_runs: 4 records where cells and no_cull_run_count have 3"},
    {"RunsOverlap", [](Contents& c) { c.voxel_runs[1].first_index = 3; },
     "voxel_runs[1].first_index: 3 where the run before ends at 6"},
    {"RunOfNoTriangle",
     [](Contents& c) {
       c.voxel_runs[0].index_count = 5;
       c.voxel_runs[1].first_index = 5;
     },
     "voxel_runs[0].index_count: 5 is not a multiple of 3"},
    {"NothingClippedInSeparateMode", [](Contents& c) { c.voxel_grid[0].mode = VoxelMode::separate; },
     "voxel_runs[0].instance: none where nothing is clipped"},
    {"RunOfWhatMoves", [](Contents& c) { c.voxel_runs[2].instance = 2; }, "voxel_runs[2].instance: 2 is dynamic"},
    {"PlacedIndex", [](Contents& c) { c.voxel_indices[7].vertex = static_cast<uint32_t>(c.positions.size()); },
     nullptr},
    {"ClippedIndex", [](Contents& c) { c.voxel_indices[23].vertex = 10; },
     "voxel_indices[23].vertex: 10 is not below the 10 voxel_vertices"},
    {"LargestIndex", [](Contents& c) { c.voxel_indices[0].vertex = none; },
     "voxel_indices[0].vertex: 4294967295 is not below the 10 voxel_vertices"},
    {"IndexOfNoRun", [](Contents& c) { c.voxel_indices.resize(27); },
     "voxel_indices: 27 records where the runs have 24"},
};

class PackVoxelRules : public testing::TestWithParam<Breach> {};

TEST_P(PackVoxelRules, BreachIsNamed) {
  const Folder folder;
  Contents contents = sample();
  ASSERT_EQ(check(view_of(contents)), "");
  GetParam().commit(contents);
  const std::string positions = std::to_string(contents.positions.size());
  const std::string expected =
      GetParam().error ? GetParam().error
                       : "voxel_indices[7].vertex: " + positions + " is not below the " + positions + " positions";
  write(folder / "a.pack", contents);
  EXPECT_EQ(open_error(folder / "a.pack"), expected);
  EXPECT_EQ(check(view_of(contents)), expected);
}

INSTANTIATE_TEST_SUITE_P(Each, PackVoxelRules, testing::ValuesIn(breaches), name_of_breach);

TEST(PackVoxels, MayBeAbsent) {
  Contents contents = sample();
  drop_grid(contents);
  EXPECT_EQ(check(view_of(contents)), "");
}

TEST(PackVoxels, MayFillAWholeWordOfCells) {
  Contents contents = sample();
  VoxelGrid& grid = contents.voxel_grid[0];
  grid.resolution = {1, 1, 32};
  contents.voxel_cells.resize(32, {4, 0});
  EXPECT_EQ(check(view_of(contents)), "");
}

}  // namespace
}  // namespace chandelier::pack::test
