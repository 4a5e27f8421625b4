// SPDX-License-Identifier: Apache-2.0
#include "lights/occupancy.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace chandelier::lights {
namespace {

// Does the axis part a triangle from a unit cell around the origin? Corners relative to the cell's middle.
bool parts(const glm::dvec3& axis, const glm::dvec3 (&corners)[3]) {
  const double reach = 0.5 * (std::abs(axis.x) + std::abs(axis.y) + std::abs(axis.z));
  const double a = glm::dot(axis, corners[0]), b = glm::dot(axis, corners[1]), c = glm::dot(axis, corners[2]);
  return std::min({a, b, c}) > reach || std::max({a, b, c}) < -reach;
}

// Separating axes (Akenine-Moeller 2001, fast 3D triangle-box overlap testing), but for the box's own.
bool overlaps(const glm::dvec3 (&corners)[3], const glm::ivec3& cell) {
  const glm::dvec3 middle = glm::dvec3(cell) + 0.5;
  const glm::dvec3 p[3] = {corners[0] - middle, corners[1] - middle, corners[2] - middle};
  if (parts(glm::cross(p[1] - p[0], p[2] - p[0]), p)) return false;
  for (int edge = 0; edge < 3; ++edge) {
    for (int axis = 0; axis < 3; ++axis) {
      glm::dvec3 unit(0.0);
      unit[axis] = 1.0;
      if (parts(glm::cross(p[(edge + 1) % 3] - p[edge], unit), p)) return false;
    }
  }
  return true;
}

// The part of the way from a to b, both in cells, that lies in the grid; none where the second is not above the first.
glm::dvec2 part_in_grid(const glm::ivec3& resolution, const glm::dvec3& a, const glm::dvec3& b) {
  glm::dvec2 part(0.0, 1.0);
  for (int axis = 0; axis < 3; ++axis) {
    const double way = b[axis] - a[axis];
    if (way == 0.0) {
      if (a[axis] < 0.0 || a[axis] >= resolution[axis]) return {0.0, 0.0};
      continue;
    }
    const double t0 = -a[axis] / way, t1 = (resolution[axis] - a[axis]) / way;
    part = {std::max(part.x, std::min(t0, t1)), std::min(part.y, std::max(t0, t1))};
  }
  return part;
}

}  // namespace

Occupancy::Occupancy(const pack::View& pack) {
  if (pack.voxel_grid.empty())
    throw std::invalid_argument("walls voxels: the pack has none (chandelier-bake --voxels); use walls rays");
  const pack::VoxelGrid& grid = pack.voxel_grid[0];
  low_ws_ = glm::dvec3(grid.bounds_min_ws);
  cell_size_m_ = glm::dvec3(grid.cell_size_m);
  resolution_ = glm::ivec3(grid.resolution[0], grid.resolution[1], grid.resolution[2]);
  for (const pack::VoxelWord& word : pack.voxel_occupancy) bits_.push_back(word.bits);
  add_large_triangles(pack);
}

void Occupancy::add_large_triangles(const pack::View& pack) {
  const pack::VoxelGrid& grid = pack.voxel_grid[0];
  const auto position_ws = [&](const pack::VoxelRun& run, uint32_t vertex) {
    if (run.instance == pack::none) return pack.voxel_vertices[vertex].position_ws;
    const auto& rows = pack.instances[run.instance].world_from_local;
    const glm::vec4 p(pack.positions[vertex].position_ls, 1.0f);
    return glm::vec3(glm::dot(rows[0], p), glm::dot(rows[1], p), glm::dot(rows[2], p));
  };
  for (const pack::VoxelRun& run : pack.voxel_runs.subspan(grid.no_cull_first_run, grid.no_cull_run_count)) {
    for (uint32_t i = run.first_index; i < run.first_index + run.index_count; i += 3) {
      glm::dvec3 corners[3];
      for (uint32_t k = 0; k < 3; ++k)
        corners[k] = (glm::dvec3(position_ws(run, pack.voxel_indices[i + k].vertex)) - low_ws_) / cell_size_m_;
      add(corners);
    }
  }
}

void Occupancy::add(const glm::dvec3 (&corners)[3]) {
  const glm::dvec3 most(resolution_ - 1);
  const glm::dvec3 low = glm::min(glm::min(corners[0], corners[1]), corners[2]);
  const glm::dvec3 high = glm::max(glm::max(corners[0], corners[1]), corners[2]);
  const glm::ivec3 first(glm::clamp(glm::floor(low), glm::dvec3(0.0), most));
  const glm::ivec3 last(glm::clamp(glm::floor(high), glm::dvec3(0.0), most));
  for (int z = first.z; z <= last.z; ++z) {
    for (int y = first.y; y <= last.y; ++y) {
      for (int x = first.x; x <= last.x; ++x) {
        if (!overlaps(corners, {x, y, z})) continue;
        const auto number = static_cast<uint32_t>(x + resolution_.x * (y + resolution_.y * z));
        bits_[number / 32] |= 1u << (number % 32);
      }
    }
  }
}

bool Occupancy::is_occupied(const glm::ivec3& cell) const {
  for (int axis = 0; axis < 3; ++axis)
    if (cell[axis] < 0 || cell[axis] >= resolution_[axis]) return false;
  const auto number = static_cast<uint32_t>(cell.x + resolution_.x * (cell.y + resolution_.y * cell.z));
  return (bits_[number / 32] >> (number % 32) & 1u) != 0;
}

// From cell to cell (Amanatides and Woo 1987, a fast voxel traversal algorithm).
bool Occupancy::between(const glm::vec3& a_ws, const glm::vec3& b_ws) const {
  const glm::dvec3 a = (glm::dvec3(a_ws) - low_ws_) / cell_size_m_, b = (glm::dvec3(b_ws) - low_ws_) / cell_size_m_;
  const glm::dvec3 way = b - a;
  const glm::dvec2 part = part_in_grid(resolution_, a, b);
  if (!(part.x < part.y)) return false;
  // Ends may lie far outside: only whether a cell is theirs matters.
  const auto cell_of = [](const glm::dvec3& p) { return glm::ivec3(glm::clamp(glm::floor(p), -2.0, 4096.0)); };
  const glm::ivec3 first = cell_of(a), last = cell_of(b);
  glm::ivec3 cell = cell_of(a + way * part.x), step(0);
  glm::dvec3 next(INFINITY), per_cell(INFINITY);
  for (int axis = 0; axis < 3; ++axis) {
    if (way[axis] == 0.0) continue;
    step[axis] = way[axis] > 0.0 ? 1 : -1;
    per_cell[axis] = 1.0 / std::abs(way[axis]);
    next[axis] = (cell[axis] + (step[axis] > 0 ? 1 : 0) - a[axis]) / way[axis];
  }
  while (true) {
    if (cell != first && cell != last && is_occupied(cell)) return true;
    const int axis = next.x <= next.y && next.x <= next.z ? 0 : (next.y <= next.z ? 1 : 2);
    if (next[axis] >= part.y) return false;
    cell[axis] += step[axis];
    next[axis] += per_cell[axis];
  }
}

}  // namespace chandelier::lights
