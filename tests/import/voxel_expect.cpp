// SPDX-License-Identifier: Apache-2.0
// What tests expect of any pack's voxels, by cutting each triangle with the planes of the cells around it.
#include "voxel_expect.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <vector>

#include "bake/voxel_grid.h"
#include "pack_checks.h"

namespace chandelier::baker::test {
namespace {

using Point = std::array<long double, 3>;
using Polygon = std::vector<Point>;

/// The part of a convex polygon on one side of a plane, its border included.
Polygon side_of(const Polygon& polygon, size_t axis, long double plane, bool above) {
  const auto height = [&](const Point& p) { return above ? p[axis] - plane : plane - p[axis]; };
  Polygon out;
  for (size_t i = 0; i < polygon.size(); ++i) {
    const Point &a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
    const long double ha = height(a), hb = height(b);
    if (ha >= 0) out.push_back(a);
    if ((ha > 0 && hb < 0) || (ha < 0 && hb > 0)) {
      Point p;
      for (size_t k = 0; k < 3; ++k) p[k] = a[k] + ha / (ha - hb) * (b[k] - a[k]);
      p[axis] = plane;
      out.push_back(p);
    }
  }
  return out;
}

/// Whether a triangle reaches into a cell that is wider by `more` on each side: cut by its six planes, something is
/// left.
bool reaches(const Polygon& triangle, const Grid& grid, const glm::ivec3& cell, double more) {
  Polygon rest = triangle;
  for (int axis = 0; axis < 3; ++axis) {
    const auto k = static_cast<size_t>(axis);
    rest = side_of(rest, k, grid.plane(axis, cell[axis]) - more, true);
    rest = side_of(rest, k, grid.plane(axis, cell[axis] + 1) + more, false);
  }
  return !rest.empty();
}

Polygon triangle_ws(const pack::Contents& pack, const pack::Instance& instance, const uint32_t* vertices) {
  Polygon out(3);
  for (size_t c = 0; c < 3; ++c) {
    const glm::vec3& p = pack.positions[vertices[c]].position_ls;
    for (size_t k = 0; k < 3; ++k) {
      const glm::vec4& row = instance.world_from_local[k];
      out[c][k] = static_cast<long double>(row.x) * p.x + static_cast<long double>(row.y) * p.y +
                  static_cast<long double>(row.z) * p.z + row.w;
    }
  }
  return out;
}

long double area_m2(const Polygon& t) {
  Point a, b, cross;
  for (size_t k = 0; k < 3; ++k) a[k] = t[1][k] - t[0][k], b[k] = t[2][k] - t[0][k];
  for (size_t k = 0; k < 3; ++k) cross[k] = a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3];
  return std::sqrt(cross[0] * cross[0] + cross[1] * cross[1] + cross[2] * cross[2]) / 2;
}

/// How often each static triangle is drawn.
std::map<Placed, int> static_triangles(const pack::Contents& pack) {
  std::map<Placed, int> out;
  for (const pack::BatchInstance& draw : pack.batch_instances) {
    if (pack.instances[draw.instance].dynamic) continue;
    const pack::Batch& batch = pack.batches[draw.batch];
    for (uint32_t i = batch.first_index; i < batch.first_index + batch.index_count; i += 3) {
      ++out[{draw.instance, pack.indices[i].vertex, pack.indices[i + 1].vertex, pack.indices[i + 2].vertex}];
    }
  }
  return out;
}

/// The cells around a triangle's box that it reaches, up to three.
std::set<uint32_t> reached_cells(const Polygon& t, const Grid& grid, double more) {
  glm::ivec3 low, high;
  for (int axis = 0; axis < 3; ++axis) {
    const auto k = static_cast<size_t>(axis);
    const auto [least, most] = std::minmax({t[0][k], t[1][k], t[2][k]});
    low[axis] = std::max(0, grid.cell_of(axis, static_cast<double>(least)) - 1);
    high[axis] = std::min(grid.resolution[axis] - 1, grid.cell_of(axis, static_cast<double>(most)) + 1);
  }
  std::set<uint32_t> out;
  for (glm::ivec3 cell = low; cell.z <= high.z; ++cell.z) {
    for (cell.y = low.y; cell.y <= high.y; ++cell.y) {
      for (cell.x = low.x; cell.x <= high.x && out.size() < 3; ++cell.x) {
        if (reaches(t, grid, cell, more)) out.insert(grid.number(cell));
      }
    }
  }
  return out;
}

long double static_area_m2(const pack::Contents& pack) {
  long double area = 0;
  for (const auto& [placed, times] : static_triangles(pack)) {
    area += times * area_m2(triangle_ws(pack, pack.instances[placed[0]], &placed[1]));
  }
  return area;
}

Polygon clipped_triangle(const pack::Contents& pack, uint32_t first_index) {
  Polygon t(3);
  for (uint32_t c = 0; c < 3; ++c) {
    const glm::vec3& p = pack.voxel_vertices[pack.voxel_indices[first_index + c].vertex].position_ws;
    t[c] = {p.x, p.y, p.z};
  }
  return t;
}

}  // namespace

std::map<Placed, std::map<uint32_t, int>> cells_of_triangles(const pack::Contents& pack) {
  std::map<Placed, std::map<uint32_t, int>> out;
  const auto read = [&](uint32_t cell, uint32_t first_run, uint32_t run_count) {
    for (uint32_t r = first_run; r < first_run + run_count; ++r) {
      const pack::VoxelRun& run = pack.voxel_runs[r];
      for (uint32_t i = run.first_index; i < run.first_index + run.index_count; i += 3) {
        const pack::VoxelIndex* corner = &pack.voxel_indices[i];
        ++out[{run.instance, corner[0].vertex, corner[1].vertex, corner[2].vertex}][cell];
      }
    }
  };
  const auto cell_count = static_cast<uint32_t>(pack.voxel_cells.size());
  for (uint32_t c = 0; c < cell_count; ++c) read(c, pack.voxel_cells[c].first_run, pack.voxel_cells[c].run_count);
  read(cell_count, pack.voxel_grid[0].no_cull_first_run, pack.voxel_grid[0].no_cull_run_count);
  return out;
}

void expect_separate(const pack::Contents& pack) {
  ASSERT_EQ(pack.voxel_grid.size(), 1u);
  ASSERT_EQ(pack.voxel_grid[0].mode, pack::VoxelMode::separate);
  ASSERT_EQ(pack::check(pack::view_of(pack)), "");
  const Grid grid(pack.voxel_grid[0]);
  const double doubt = 1e-10 * grid.scale_m;
  const auto placed_in = cells_of_triangles(pack);
  const std::map<Placed, int> drawn = static_triangles(pack);
  EXPECT_EQ(placed_in.size(), drawn.size());
  for (const auto& [placed, times] : drawn) {
    const auto found = placed_in.find(placed);
    ASSERT_NE(found, placed_in.end()) << "triangle of vertex " << placed[1] << " is nowhere";
    for (const auto& [cell, count] : found->second) ASSERT_EQ(count, times) << cell;
    const Polygon t = triangle_ws(pack, pack.instances[placed[0]], &placed[1]);
    const std::set<uint32_t> surely = reached_cells(t, grid, -doubt), perhaps = reached_cells(t, grid, doubt);
    if (found->second.count(grid.cell_count())) {
      EXPECT_EQ(found->second.size(), 1u);
      EXPECT_GT(perhaps.size(), 2u);
      continue;
    }
    EXPECT_LE(surely.size(), 2u);
    for (const uint32_t cell : surely) EXPECT_TRUE(found->second.count(cell)) << "cell " << cell << " misses one";
    for (const auto& [cell, count] : found->second)
      EXPECT_TRUE(perhaps.count(cell)) << "cell " << cell << " has one more";
  }
}

void expect_clipped(const pack::Contents& pack) {
  ASSERT_EQ(pack.voxel_grid.size(), 1u);
  ASSERT_EQ(pack.voxel_grid[0].mode, pack::VoxelMode::clip);
  ASSERT_EQ(pack::check(pack::view_of(pack)), "");
  EXPECT_EQ(pack.voxel_grid[0].no_cull_run_count, 0u);
  const Grid grid(pack.voxel_grid[0]);
  const double rounding = grid.scale_m * 0x1p-23;
  long double area = 0;
  glm::ivec3 at(0);
  for (at.z = 0; at.z < grid.resolution.z; ++at.z) {
    for (at.y = 0; at.y < grid.resolution.y; ++at.y) {
      for (at.x = 0; at.x < grid.resolution.x; ++at.x) {
        const pack::VoxelCell& cell = pack.voxel_cells[grid.number(at)];
        std::map<std::array<float, 5>, uint32_t> vertices;
        for (uint32_t r = 0; r < cell.run_count; ++r) {
          const pack::VoxelRun& run = pack.voxel_runs[cell.first_run + r];
          ASSERT_EQ(run.instance, pack::none);
          for (uint32_t i = run.first_index; i < run.first_index + run.index_count; i += 3) {
            const Polygon t = clipped_triangle(pack, i);
            const long double part = area_m2(t);
            EXPECT_GT(part, 0);
            area += part;
            for (int axis = 0; axis < 3; ++axis) {
              for (const Point& p : t) {
                ASSERT_GE(p[static_cast<size_t>(axis)], grid.plane(axis, at[axis]) - rounding);
                ASSERT_LE(p[static_cast<size_t>(axis)], grid.plane(axis, at[axis] + 1) + rounding);
              }
            }
            for (uint32_t c = 0; c < 3; ++c) {
              const uint32_t number = pack.voxel_indices[i + c].vertex;
              const pack::VoxelVertex& v = pack.voxel_vertices[number];
              const std::array<float, 5> key = {v.position_ws.x, v.position_ws.y, v.position_ws.z, v.uv.x, v.uv.y};
              ASSERT_EQ(vertices.try_emplace(key, number).first->second, number) << "the same vertex twice in a cell";
            }
          }
        }
      }
    }
  }
  const long double expected = static_area_m2(pack);
  EXPECT_NEAR(static_cast<double>(area / expected), 1, 1e-4);
}

}  // namespace chandelier::baker::test
