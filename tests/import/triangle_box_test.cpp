// SPDX-License-Identifier: Apache-2.0
// Triangles against boxes: no overlap missed, none made up, beside an exact test in whole numbers; and cutting to
// cells.
#include "bake/triangle_box.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <random>

#include "bake/clip.h"
#include "bake/voxel_grid.h"

namespace chandelier::baker::test {
namespace {

using Int3 = std::array<long, 3>;
using IntTriangle = std::array<Int3, 3>;

struct IntBox {
  Int3 low, high;
};

bool contains(const IntBox& box, const Int3& p) {
  for (size_t k = 0; k < 3; ++k) {
    if (p[k] < box.low[k] || p[k] > box.high[k]) return false;
  }
  return true;
}

/// Whether the closed segment a + t (b - a) meets the closed box: the bounds of t as fractions.
bool segment_meets(const IntBox& box, const Int3& a, const Int3& b) {
  long from = 0, from_over = 1, to = 1, to_over = 1;
  for (size_t k = 0; k < 3; ++k) {
    long step = b[k] - a[k], low = box.low[k] - a[k], high = box.high[k] - a[k];
    if (step == 0) {
      if (low > 0 || high < 0) return false;
      continue;
    }
    if (step < 0) {
      step = -step;
      std::swap(low, high);
      low = -low, high = -high;
    }
    if (low * from_over > from * step) from = low, from_over = step;
    if (high * to_over < to * step) to = high, to_over = step;
  }
  return from * to_over <= to * from_over;
}

/// Whether the closed edge of the box that runs along axis k, at u, v on the next two axes, meets the closed triangle.
/// False where the triangle is parallel to the edge: then one of its own edges or another edge of the box meets.
bool box_edge_meets(const IntTriangle& t, size_t k, long u, long v, long low, long high) {
  const size_t i = (k + 1) % 3, j = (k + 2) % 3;
  std::array<long, 3> weight;
  for (size_t c = 0; c < 3; ++c) {
    const Int3 &p = t[(c + 1) % 3], &q = t[(c + 2) % 3];
    weight[c] = (p[i] - u) * (q[j] - v) - (p[j] - v) * (q[i] - u);
  }
  long sum = weight[0] + weight[1] + weight[2];
  if (sum == 0) return false;
  const long sign = sum < 0 ? -1 : 1;
  long height = 0;
  for (size_t c = 0; c < 3; ++c) {
    if (weight[c] * sign < 0) return false;
    height += weight[c] * sign * t[c][k];
  }
  sum *= sign;
  return height >= low * sum && height <= high * sum;
}

/// The intersection of both is a polygon; where it is not empty it has a corner: one of the triangle in the box, one of
/// the triangle's edges on a face, or an edge of the box in the triangle. All in whole numbers, so exact.
bool exactly_overlap(const IntTriangle& t, const IntBox& box) {
  for (size_t c = 0; c < 3; ++c) {
    if (contains(box, t[c]) || segment_meets(box, t[c], t[(c + 1) % 3])) return true;
  }
  for (size_t k = 0; k < 3; ++k) {
    const size_t i = (k + 1) % 3, j = (k + 2) % 3;
    for (const long u : {box.low[i], box.high[i]}) {
      for (const long v : {box.low[j], box.high[j]}) {
        if (box_edge_meets(t, k, u, v, box.low[k], box.high[k])) return true;
      }
    }
  }
  return false;
}

glm::dvec3 as_double(const Int3& p) {
  return {static_cast<double>(p[0]), static_cast<double>(p[1]), static_cast<double>(p[2])};
}

bool tested_overlap(const IntTriangle& t, const IntBox& box, double slack) {
  return may_overlap({as_double(t[0]), as_double(t[1]), as_double(t[2])}, as_double(box.low), as_double(box.high),
                     slack);
}

/// With small whole numbers, corners lie on faces, edges and corners of the box, triangles in its faces, and slivers
/// without area are common. Where there is no overlap, an axis of whole numbers keeps both 1 apart: the test must say
/// so.
TEST(TriangleBox, AgreesWithExactTestOnSmallWholeNumbers) {
  std::mt19937 random(1);
  int overlapping = 0, apart = 0;
  for (const long range : {2, 3, 6, 20}) {
    std::uniform_int_distribution<long> number(-range, range), size(1, range);
    for (int i = 0; i < 150000; ++i) {
      IntTriangle t;
      for (Int3& corner : t) corner = {number(random), number(random), number(random)};
      IntBox box{{number(random), number(random), number(random)}, {}};
      for (size_t k = 0; k < 3; ++k) box.high[k] = box.low[k] + size(random);
      const bool expected = exactly_overlap(t, box);
      ++(expected ? overlapping : apart);
      ASSERT_EQ(tested_overlap(t, box, 0x1p-47 * 64), expected)
          << t[0][0] << ' ' << t[0][1] << ' ' << t[0][2] << ", " << t[1][0] << ' ' << t[1][1] << ' ' << t[1][2] << ", "
          << t[2][0] << ' ' << t[2][1] << ' ' << t[2][2] << " in " << box.low[0] << ' ' << box.low[1] << ' '
          << box.low[2] << " to " << box.high[0] << ' ' << box.high[1] << ' ' << box.high[2];
    }
  }
  EXPECT_GT(overlapping, 100000);
  EXPECT_GT(apart, 100000);
}

/// Numbers as large as exact products in a long allow; triangles touch the box with a corner or are slivers past
/// it.
TEST(TriangleBox, MissesNothingThatTouchesOnLargeWholeNumbers) {
  std::mt19937 random(2);
  constexpr long range_steps = 1 << 16;
  std::uniform_int_distribution<long> number(-range_steps, range_steps), near(-2, 2), which(0, 2);
  int overlapping = 0;
  for (int i = 0; i < 300000; ++i) {
    IntBox box{{number(random), number(random), number(random)}, {}};
    for (size_t k = 0; k < 3; ++k) box.high[k] = box.low[k] + 1 + std::abs(number(random)) / 64;
    // Two corners anywhere, the third beyond a point of the box's surface or an ulp beside it.
    Int3 target;
    for (size_t k = 0; k < 3; ++k) {
      const long at[] = {box.low[k], box.high[k], (box.low[k] + box.high[k]) / 2};
      target[k] = at[which(random)] + near(random);
    }
    IntTriangle t;
    for (size_t c = 0; c < 2; ++c) t[c] = {number(random) / 2, number(random) / 2, number(random) / 2};
    for (size_t k = 0; k < 3; ++k) t[2][k] = 2 * target[k] - t[0][k];  // the target halves an edge
    if (i % 2) {
      for (size_t k = 0; k < 3; ++k) t[1][k] = t[0][k] + near(random);
    }
    const bool expected = exactly_overlap(t, box);
    overlapping += expected;
    ASSERT_TRUE(!expected || tested_overlap(t, box, 0x1p-47 * 4 * range_steps)) << i;
  }
  EXPECT_GT(overlapping, 50000);
}

TEST(TriangleBox, MissesNoSampledPoint) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> unit(0, 1), around(-3, 3);
  int hits = 0;
  for (int i = 0; i < 2000; ++i) {
    const glm::dvec3 origin(around(random) * 1e6, around(random), around(random) * 1e3);
    const glm::dvec3 box_min = origin + glm::dvec3(around(random), around(random), around(random)) * 0.2;
    const glm::dvec3 box_max = box_min + glm::dvec3(unit(random), unit(random), unit(random));
    Triangle t;
    for (glm::dvec3& corner : t) corner = origin + glm::dvec3(around(random), around(random), around(random));
    if (i % 3 == 0) t[2] = t[0] + (t[1] - t[0]) * unit(random);  // a sliver
    if (i % 5 == 0) t[0] = t[1] = t[2];                          // a point
    bool inside = false;
    for (int s = 0; s < 4000 && !inside; ++s) {
      double u = unit(random), v = unit(random);
      if (u + v > 1) u = 1 - u, v = 1 - v;
      const glm::dvec3 p = t[0] + u * (t[1] - t[0]) + v * (t[2] - t[0]);
      inside = glm::all(glm::greaterThanEqual(p, box_min)) && glm::all(glm::lessThanEqual(p, box_max));
    }
    hits += inside;
    ASSERT_TRUE(!inside || may_overlap(t, box_min, box_max, 0x1p-47 * 4e6)) << i;
  }
  EXPECT_GT(hits, 100);
}

// Cutting

pack::VoxelGrid grid_of_ones(uint32_t side) {
  pack::VoxelGrid grid;
  grid.cell_size_m = {1, 1, 1};
  grid.resolution = {side, side, side};
  return grid;
}

double area_m2(const ClipPolygon& polygon) {
  glm::dvec3 sum(0);
  for (size_t i = 2; i < polygon.size(); ++i) {
    sum += glm::cross(polygon[i - 1].position - polygon[0].position, polygon[i].position - polygon[0].position);
  }
  return glm::length(sum) / 2;
}

using Pieces = std::map<uint32_t, ClipPolygon>;

/// Cuts a triangle; each cell at most once, each corner in its closed cell.
Pieces cut(const Grid& grid, const Triangle& t) {
  Pieces pieces;
  Clipper clipper(grid);
  clipper.cut({ClipVertex{t[0]}, ClipVertex{t[1]}, ClipVertex{t[2]}}, [&](uint32_t number, const ClipPolygon& part) {
    EXPECT_TRUE(pieces.emplace(number, part).second) << "cell " << number << " twice";
    const auto n = static_cast<int>(number);
    const glm::ivec3 cell(n % grid.resolution.x, n / grid.resolution.x % grid.resolution.y,
                          n / grid.resolution.x / grid.resolution.y);
    for (const ClipVertex& vertex : part) {
      for (int axis = 0; axis < 3; ++axis) {
        EXPECT_GE(vertex.position[axis], grid.plane(axis, cell[axis]) - 1e-12);
        EXPECT_LE(vertex.position[axis], grid.plane(axis, cell[axis] + 1) + 1e-12);
      }
    }
  });
  return pieces;
}

double total_area_m2(const Pieces& pieces) {
  double sum = 0;
  for (const auto& [cell, part] : pieces) sum += area_m2(part);
  return sum;
}

TEST(Clip, KeepsTheAreaOfAnyTriangle) {
  const Grid grid(grid_of_ones(8));
  std::mt19937 random(4);
  std::uniform_real_distribution<double> inside(0.01, 7.99);
  std::uniform_int_distribution<int> whole(1, 7);
  for (int i = 0; i < 3000; ++i) {
    Triangle t;
    for (glm::dvec3& corner : t) {
      corner = i % 2 ? glm::dvec3(inside(random), inside(random), inside(random))
                     : glm::dvec3(whole(random), whole(random), whole(random));  // on corners of cells
    }
    const double area = area_m2({ClipVertex{t[0]}, ClipVertex{t[1]}, ClipVertex{t[2]}});
    ASSERT_NEAR(total_area_m2(cut(grid, t)), area, 1e-11) << i;
  }
}

TEST(Clip, CutsASquareOfTwoTrianglesIntoEachCellOnce) {
  const Grid grid(grid_of_ones(8));
  // 4 by 4 cells in the plane z = 2.5, its border half way through cells: 5 by 5 cells, 16 m2.
  const glm::dvec3 a(1.5, 2.5, 2.5), b(5.5, 2.5, 2.5), c(5.5, 6.5, 2.5), d(1.5, 6.5, 2.5);
  std::map<uint32_t, double> areas;
  for (const Triangle& t : {Triangle{a, b, c}, Triangle{a, c, d}}) {
    for (const auto& [cell, part] : cut(grid, t)) areas[cell] += area_m2(part);
  }
  ASSERT_EQ(areas.size(), 25u);
  for (int y = 2; y <= 6; ++y) {
    for (int x = 1; x <= 5; ++x) {
      const double expected = (x == 1 || x == 5 ? 0.5 : 1) * (y == 2 || y == 6 ? 0.5 : 1);
      EXPECT_NEAR(areas[grid.number({x, y, 2})], expected, 1e-12) << x << ' ' << y;
    }
  }
}

TEST(Clip, PutsWhatLiesInAFaceIntoTheUpperCellAlone) {
  const Grid grid(grid_of_ones(4));
  for (int axis = 0; axis < 3; ++axis) {
    Triangle t = {glm::dvec3(1.25), glm::dvec3(1.75), glm::dvec3(1.25)};
    t[2][(axis + 1) % 3] = 1.75;
    for (glm::dvec3& corner : t) corner[axis] = 2;
    glm::ivec3 cell(1);
    cell[axis] = 2;
    const Pieces pieces = cut(grid, t);
    ASSERT_EQ(pieces.size(), 1u);
    EXPECT_EQ(pieces.begin()->first, grid.number(cell));
    // Touching the face from below or from above with an edge is no reason to be in the cell behind it.
    for (const int side : {1, 2}) {
      t[0][axis] = side == 1 ? 1.5 : 2.5;
      cell[axis] = side;
      const Pieces touching = cut(grid, t);
      ASSERT_EQ(touching.size(), 1u) << side;
      EXPECT_EQ(touching.begin()->first, grid.number(cell));
    }
  }
}

TEST(Clip, OpensNoCrackBetweenNeighbours) {
  // Two triangles share an edge: both must cut it at the same points, bit by bit.
  const Grid grid(grid_of_ones(8));
  std::mt19937 random(5);
  std::uniform_real_distribution<double> inside(0.01, 7.99);
  for (int i = 0; i < 500; ++i) {
    glm::dvec3 p[4];
    for (glm::dvec3& corner : p) corner = {inside(random), inside(random), inside(random)};
    // The points of each triangle's parts that lie on the shared edge p0 p1.
    const auto on_edge = [&](const Triangle& t) {
      std::vector<std::array<double, 3>> points;
      for (const auto& [cell, part] : cut(grid, t)) {
        for (const ClipVertex& vertex : part) {
          const glm::dvec3 d = p[1] - p[0], r = vertex.position - p[0];
          if (glm::length(glm::cross(d, r)) > 1e-10 * glm::length(d)) continue;
          points.push_back({vertex.position.x, vertex.position.y, vertex.position.z});
        }
      }
      std::sort(points.begin(), points.end());
      points.erase(std::unique(points.begin(), points.end()), points.end());
      return points;
    };
    EXPECT_EQ(on_edge({p[0], p[1], p[2]}), on_edge({p[1], p[0], p[3]})) << i;
  }
}

TEST(UniqueVertices, KeepFirstOccurrences) {
  UniqueVertices unique;
  unique.reset(1000);
  std::mt19937 random(6);
  std::uniform_int_distribution<int> number(0, 5);
  std::map<std::array<float, 4>, uint32_t> expected;
  for (int i = 0; i < 1000; ++i) {
    const std::array<float, 4> v = {static_cast<float>(number(random)), static_cast<float>(number(random)),
                                    static_cast<float>(number(random)) * 1e-20f, static_cast<float>(number(random))};
    const auto found = expected.try_emplace(v, static_cast<uint32_t>(expected.size())).first;
    EXPECT_EQ(unique.add({{v[0], v[1], v[2]}, {v[3], 7}}), found->second);
  }
  EXPECT_EQ(unique.vertices().size(), expected.size());
  EXPECT_LT(expected.size(), 700u);
}

// Grids

TEST(Grid, HoldsABoxWithRoomAroundIt) {
  struct {
    glm::vec3 low, high;
  } const boxes[] = {
      {{-18, -1, -11}, {19, 14, 10}},         {{0, 0, 0}, {1, 0, 1}},          {{5, 5, 5}, {5, 5, 5}},
      {{1e6f, 0, 0}, {1e6f, 1, 1}},           {{-1e30f, 0, 3}, {1e30f, 0, 3}}, {{0, 0, 0}, {1e-20f, 0, 0}},
      {{-3e7f, -1e-3f, 0}, {-2e7f, 1e-3f, 0}}};
  for (const auto& box : boxes) {
    for (const std::array<uint32_t, 3>& resolution : {std::array<uint32_t, 3>{1, 1, 1}, {32, 32, 32}, {1024, 3, 7}}) {
      const pack::VoxelGrid record = make_voxel_grid(box.low, box.high, resolution, pack::VoxelMode::separate);
      const Grid grid(record);
      for (int axis = 0; axis < 3; ++axis) {
        EXPECT_GT(record.cell_size_m[axis], 0);
        EXPECT_LT(grid.low[axis], box.low[axis]);
        EXPECT_GT(grid.plane(axis, grid.resolution[axis]), box.high[axis]);
      }
    }
  }
}

TEST(Grid, IsHardlyWiderThanItsBox) {
  const Grid grid(make_voxel_grid({-18, -1, -11}, {19, 14, 10}, {32, 32, 32}, pack::VoxelMode::separate));
  const glm::dvec3 spare = grid.cell_size * 32.0 - glm::dvec3(37, 15, 21);
  for (int axis = 0; axis < 3; ++axis) EXPECT_LT(spare[axis], 0.01);
}

TEST(Grid, GivesAPointInAPlaneToTheCellAbove) {
  const pack::VoxelGrid record = make_voxel_grid({-1, -2, -3}, {5, 7, 9}, {10, 100, 1000}, pack::VoxelMode::clip);
  const Grid grid(record);
  for (int axis = 0; axis < 3; ++axis) {
    for (int cell = 1; cell < grid.resolution[axis]; ++cell) {
      const double plane = grid.plane(axis, cell);
      EXPECT_EQ(grid.cell_of(axis, plane), cell);
      EXPECT_EQ(grid.cell_of(axis, std::nextafter(plane, -1e9)), cell - 1);
      EXPECT_LE(std::abs(grid.about_cell_of(axis, plane) - cell), 1);
    }
  }
}

TEST(Grid, KnowsTheCellOfAPoint) {
  pack::VoxelGrid record = grid_of_ones(4);
  EXPECT_EQ(cell_at(record, {0.5f, 1.5f, 2.5f}), 0u + 4 * (1 + 4 * 2));
  EXPECT_EQ(cell_at(record, {0, 0, 0}), 0u);
  EXPECT_EQ(cell_at(record, {3.999f, 3.999f, 3.999f}), 63u);
  EXPECT_EQ(cell_at(record, {4, 1, 1}), pack::none);
  EXPECT_EQ(cell_at(record, {1, -0.001f, 1}), pack::none);
  EXPECT_EQ(cell_at(record, {1, NAN, 1}), pack::none);
}

}  // namespace
}  // namespace chandelier::baker::test
