// SPDX-License-Identifier: Apache-2.0
// Voxel bins: every static triangle in every cell that it overlaps or always drawn; clipped, all of its area once.
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <map>
#include <random>
#include <set>

#include "bake/voxel_bins.h"
#include "bake/voxel_grid.h"
#include "gltf_builder.h"
#include "import/import.h"
#include "pack_checks.h"

namespace chandelier::baker::test {
namespace {

using Point = std::array<long double, 3>;
using Polygon = std::vector<Point>;

/// The part of a convex polygon on one side of a plane, its border included.
Polygon side_of(const Polygon& polygon, std::size_t axis, long double plane, bool above) {
  const auto height = [&](const Point& p) { return above ? p[axis] - plane : plane - p[axis]; };
  Polygon out;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Point &a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
    const long double ha = height(a), hb = height(b);
    if (ha >= 0) out.push_back(a);
    if ((ha > 0 && hb < 0) || (ha < 0 && hb > 0)) {
      Point p;
      for (std::size_t k = 0; k < 3; ++k) p[k] = a[k] + ha / (ha - hb) * (b[k] - a[k]);
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
    const auto k = static_cast<std::size_t>(axis);
    rest = side_of(rest, k, grid.plane(axis, cell[axis]) - more, true);
    rest = side_of(rest, k, grid.plane(axis, cell[axis] + 1) + more, false);
  }
  return !rest.empty();
}

Polygon triangle_ws(const pack::Contents& pack, const pack::Instance& instance, const std::uint32_t* vertices) {
  Polygon out(3);
  for (std::size_t c = 0; c < 3; ++c) {
    const glm::vec3& p = pack.positions[vertices[c]].position_ls;
    for (std::size_t k = 0; k < 3; ++k) {
      const glm::vec4& row = instance.world_from_local[k];
      out[c][k] = static_cast<long double>(row.x) * p.x + static_cast<long double>(row.y) * p.y +
                  static_cast<long double>(row.z) * p.z + row.w;
    }
  }
  return out;
}

long double area_m2(const Polygon& t) {
  Point a, b, cross;
  for (std::size_t k = 0; k < 3; ++k) a[k] = t[1][k] - t[0][k], b[k] = t[2][k] - t[0][k];
  for (std::size_t k = 0; k < 3; ++k) cross[k] = a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3];
  return std::sqrt(cross[0] * cross[0] + cross[1] * cross[1] + cross[2] * cross[2]) / 2;
}

/// A placed triangle: instance and vertices, as drawn.
using Placed = std::array<std::uint32_t, 4>;

/// How often each static triangle is drawn.
std::map<Placed, int> static_triangles(const pack::Contents& pack) {
  std::map<Placed, int> out;
  for (const pack::BatchInstance& draw : pack.batch_instances) {
    if (pack.instances[draw.instance].dynamic) continue;
    const pack::Batch& batch = pack.batches[draw.batch];
    for (std::uint32_t i = batch.first_index; i < batch.first_index + batch.index_count; i += 3) {
      ++out[{draw.instance, pack.indices[i].vertex, pack.indices[i + 1].vertex, pack.indices[i + 2].vertex}];
    }
  }
  return out;
}

/// {placed triangle: {cell: how often}}; the count of cells stands for no cell. Runs must have the triangle's material.
std::map<Placed, std::map<std::uint32_t, int>> cells_of_triangles(const pack::Contents& pack) {
  std::map<Placed, std::map<std::uint32_t, int>> out;
  const auto read = [&](std::uint32_t cell, std::uint32_t first_run, std::uint32_t run_count) {
    for (std::uint32_t r = first_run; r < first_run + run_count; ++r) {
      const pack::VoxelRun& run = pack.voxel_runs[r];
      for (std::uint32_t i = run.first_index; i < run.first_index + run.index_count; i += 3) {
        const pack::VoxelIndex* corner = &pack.voxel_indices[i];
        ++out[{run.instance, corner[0].vertex, corner[1].vertex, corner[2].vertex}][cell];
      }
    }
  };
  const auto cell_count = static_cast<std::uint32_t>(pack.voxel_cells.size());
  for (std::uint32_t c = 0; c < cell_count; ++c) read(c, pack.voxel_cells[c].first_run, pack.voxel_cells[c].run_count);
  read(cell_count, pack.voxel_grid[0].no_cull_first_run, pack.voxel_grid[0].no_cull_run_count);
  return out;
}

/// The cells around a triangle's box that it reaches, up to three.
std::set<std::uint32_t> reached_cells(const Polygon& t, const Grid& grid, double more) {
  glm::ivec3 low, high;
  for (int axis = 0; axis < 3; ++axis) {
    const auto k = static_cast<std::size_t>(axis);
    const auto [least, most] = std::minmax({t[0][k], t[1][k], t[2][k]});
    low[axis] = std::max(0, grid.cell_of(axis, static_cast<double>(least)) - 1);
    high[axis] = std::min(grid.resolution[axis] - 1, grid.cell_of(axis, static_cast<double>(most)) + 1);
  }
  std::set<std::uint32_t> out;
  for (glm::ivec3 cell = low; cell.z <= high.z; ++cell.z) {
    for (cell.y = low.y; cell.y <= high.y; ++cell.y) {
      for (cell.x = low.x; cell.x <= high.x && out.size() < 3; ++cell.x) {
        if (reaches(t, grid, cell, more)) out.insert(grid.number(cell));
      }
    }
  }
  return out;
}

/// Every static triangle is in no cell if it surely overlaps more than two, else in all that it surely overlaps, and in
/// none that it surely does not; as often as it is drawn. "Surely" leaves out what rounding decides.
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
    const std::set<std::uint32_t> surely = reached_cells(t, grid, -doubt), perhaps = reached_cells(t, grid, doubt);
    if (found->second.count(grid.cell_count())) {
      EXPECT_EQ(found->second.size(), 1u);
      EXPECT_GT(perhaps.size(), 2u);
      continue;
    }
    EXPECT_LE(surely.size(), 2u);
    for (const std::uint32_t cell : surely) EXPECT_TRUE(found->second.count(cell)) << "cell " << cell << " misses one";
    for (const auto& [cell, count] : found->second)
      EXPECT_TRUE(perhaps.count(cell)) << "cell " << cell << " has one more";
  }
}

long double static_area_m2(const pack::Contents& pack) {
  long double area = 0;
  for (const auto& [placed, times] : static_triangles(pack)) {
    area += times * area_m2(triangle_ws(pack, pack.instances[placed[0]], &placed[1]));
  }
  return area;
}

Polygon clipped_triangle(const pack::Contents& pack, std::uint32_t first_index) {
  Polygon t(3);
  for (std::uint32_t c = 0; c < 3; ++c) {
    const glm::vec3& p = pack.voxel_vertices[pack.voxel_indices[first_index + c].vertex].position_ws;
    t[c] = {p.x, p.y, p.z};
  }
  return t;
}

/// Each clipped triangle is in its cell, to a float; their area is that of the input; no vertex of a cell comes twice.
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
        std::map<std::array<float, 5>, std::uint32_t> vertices;
        for (std::uint32_t r = 0; r < cell.run_count; ++r) {
          const pack::VoxelRun& run = pack.voxel_runs[cell.first_run + r];
          ASSERT_EQ(run.instance, pack::none);
          for (std::uint32_t i = run.first_index; i < run.first_index + run.index_count; i += 3) {
            const Polygon t = clipped_triangle(pack, i);
            const long double part = area_m2(t);
            EXPECT_GT(part, 0);
            area += part;
            for (int axis = 0; axis < 3; ++axis) {
              for (const Point& p : t) {
                ASSERT_GE(p[static_cast<std::size_t>(axis)], grid.plane(axis, at[axis]) - rounding);
                ASSERT_LE(p[static_cast<std::size_t>(axis)], grid.plane(axis, at[axis] + 1) + rounding);
              }
            }
            for (std::uint32_t c = 0; c < 3; ++c) {
              const std::uint32_t number = pack.voxel_indices[i + c].vertex;
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

/// The pack with other voxels.
pack::Contents with_voxels(pack::Contents pack, const VoxelSettings& settings, PassReport* report = nullptr) {
  pack.voxel_grid.clear(), pack.voxel_cells.clear(), pack.voxel_runs.clear();
  pack.voxel_indices.clear(), pack.voxel_vertices.clear(), pack.voxel_occupancy.clear();
  for (pack::Light& light : pack.lights) light.voxel = pack::none;
  PassReport unread;
  make_voxels(settings, Progress(false), pack, report ? *report : unread);
  return pack;
}

/// `count` triangles around points in a box of 10 m, from a hair to some metres large, in two instances, one of them
/// turned and mirrored; every second mesh masked.
GltfBuilder soup(int count, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> place(-5, 5), unit(-1, 1), power(-4, 0.5f);
  GltfBuilder gltf;
  gltf.json["materials"] = {{{"name", "stone"}}, {{"name", "leaf"}, {"alphaMode", "MASK"}}};
  for (int material = 0; material < 2; ++material) {
    std::vector<float> positions;
    for (int t = 0; t < count / 4; ++t) {
      const std::array<float, 3> middle = {place(random), place(random), place(random)};
      const float size = std::pow(10.0f, power(random));
      for (std::size_t i = 0; i < 9; ++i) positions.push_back(middle[i % 3] + size * unit(random));
    }
    gltf.add_mesh({{"attributes", {{"POSITION", gltf.add_positions(positions)}}}, {"material", material}});
    gltf.add_node({{"mesh", material}});
    gltf.add_node({{"mesh", material},
                   {"rotation", {0.1, 0.7, 0.1, 0.7}},
                   {"scale", {-0.5, 1, 1.5}},
                   {"translation", {3, 1, 2}}});
  }
  return gltf;
}

pack::Contents bake_file(const std::string& path) {
  Scene scene;
  Warnings warnings;
  import_gltf(std::string(CHANDELIER_DATA_DIR) + path, scene, warnings);
  BakeSettings settings;
  settings.images.textures = TextureMode::none;
  return bake_scene(std::move(scene), settings);
}

constexpr VoxelSettings kClip = {{32, 32, 32}, pack::VoxelMode::clip};

TEST(Voxels, HaveEachTriangleInEachCellThatItOverlaps) {
  const pack::Contents pack = soup(2000, 1).bake();
  expect_separate(pack);
  EXPECT_GT(pack.voxel_grid[0].no_cull_run_count, 0u);
  for (const std::array<std::uint32_t, 3>& resolution :
       {std::array<std::uint32_t, 3>{1, 1, 1}, {2, 2, 2}, {3, 1, 2}, {64, 5, 17}, {1, 1, 1000}}) {
    expect_separate(with_voxels(pack, {resolution, pack::VoxelMode::separate}));
  }
}

TEST(Voxels, HaveTrianglesThatLieInFacesOnBothSides) {
  // A floor of unit squares in a cube of 8 cells a side whose planes are whole numbers: all corners lie on planes.
  GltfBuilder gltf;
  std::vector<float> positions;
  for (int y = 0; y < 6; ++y) {
    for (int x = 0; x < 6; ++x) {
      const auto fx = static_cast<float>(x), fy = static_cast<float>(y);
      positions.insert(positions.end(), {fx, 2, fy, fx, 2, fy + 1, fx + 1, 2, fy});
      positions.insert(positions.end(),
                       {fx + 0.25f, 2, fy + 0.25f, fx + 0.25f, 2, fy + 0.75f, fx + 0.75f, 2, fy + 0.25f});
    }
  }
  gltf.add_mesh({{"attributes", {{"POSITION", gltf.add_positions(positions)}}}});
  gltf.add_node({{"mesh", 0}});
  const pack::Contents pack = gltf.bake();
  expect_separate(pack);
  expect_clipped(with_voxels(pack, kClip));
}

TEST(Voxels, HaveAllAreaOnceWhereTheyAreClipped) {
  const pack::Contents pack = soup(2000, 2).bake();
  for (const std::array<std::uint32_t, 3>& resolution :
       {std::array<std::uint32_t, 3>{1, 1, 1}, {2, 2, 2}, {32, 32, 32}, {3, 70, 1}}) {
    PassReport report;
    const pack::Contents clipped = with_voxels(pack, {resolution, pack::VoxelMode::clip}, &report);
    expect_clipped(clipped);
    const auto said = std::find_if(report.counts.begin(), report.counts.end(),
                                   [](const auto& count) { return count.first == "clipped_area_error"; });
    ASSERT_NE(said, report.counts.end());
    EXPECT_LT(said->second, 1e-4);
  }
}

TEST(Voxels, TellWhatTheyHold) {
  PassReport report;
  const pack::Contents pack = with_voxels(soup(1000, 3).bake(), {{8, 8, 8}, pack::VoxelMode::separate}, &report);
  std::map<std::string, double> counts(report.counts.begin(), report.counts.end());
  double occupied = 0, no_cull = 0, triangles = 0;
  for (const pack::VoxelWord& word : pack.voxel_occupancy) occupied += std::popcount(word.bits);
  for (const auto& [placed, cells] : cells_of_triangles(pack)) {
    for (const auto& [cell, count] : cells) (cell == 512 ? no_cull : triangles) += count;
  }
  EXPECT_EQ(counts["cells"], 512);
  EXPECT_EQ(counts["occupied_cells"], occupied);
  EXPECT_EQ(counts["runs"], static_cast<double>(pack.voxel_runs.size()));
  EXPECT_EQ(counts["no_cull_triangles"], no_cull);
  EXPECT_EQ(counts["triangles"], triangles + no_cull);
  EXPECT_GT(no_cull, 0);
}

TEST(Voxels, HoldLongRuns) {
  // In a cell, an instance's triangles of a material are one run, and runs follow the order of batch instances.
  const pack::Contents pack = soup(8000, 4).bake({.voxels = {{2, 2, 2}}});
  for (const pack::VoxelCell& cell : pack.voxel_cells) {
    std::set<std::array<std::uint32_t, 3>> seen;
    std::array<std::uint32_t, 3> last = {};
    for (std::uint32_t r = cell.first_run; r < cell.first_run + cell.run_count; ++r) {
      const pack::VoxelRun& run = pack.voxel_runs[r];
      const bool masked = pack.materials[run.material].alpha_mode == pack::AlphaMode::mask;
      const std::array<std::uint32_t, 3> key = {masked ? 1u : 0u, run.material, run.instance};
      EXPECT_TRUE(seen.insert(key).second);
      EXPECT_LE(last, key);
      last = key;
    }
    EXPECT_EQ(seen.size(), 4u);
  }
}

TEST(Voxels, AreLeftOutOnRequestAndWithoutTriangles) {
  const pack::Contents none = soup(100, 5).bake({.voxels = {{0, 0, 0}}});
  EXPECT_TRUE(none.voxel_grid.empty() && none.voxel_cells.empty() && none.voxel_occupancy.empty());
  EXPECT_EQ(pack::check(pack::view_of(none)), "");
  GltfBuilder nothing;
  EXPECT_TRUE(nothing.bake().voxel_grid.empty());
}

TEST(Voxels, HoldNothingThatMoves) {
  pack::Contents pack = soup(400, 6).bake();
  pack.batch_bvh.clear(), pack.batch_bvh_items.clear();  // they hold it still
  pack.instance_bvh.clear(), pack.instance_bvh_items.clear();
  pack.instances[1].dynamic = 1;
  const pack::Contents some = with_voxels(pack, {});
  expect_separate(some);
  for (const pack::VoxelRun& run : some.voxel_runs) EXPECT_NE(run.instance, 1u);
  expect_clipped(with_voxels(pack, kClip));
  for (pack::Instance& instance : pack.instances) instance.dynamic = 1;
  EXPECT_TRUE(with_voxels(pack, {}).voxel_grid.empty());
}

TEST(Voxels, HoldFlatScenes) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    std::vector<float> positions = {0, 0, 0, 4, 4, 4, 0, 0, 0, 1, 1, 1, 1.1f, 1.1f, 1.1f, 1, 1, 1};
    positions[(axis + 1) % 3 + 6] = positions[(axis + 1) % 3 + 15] = 3;
    for (std::size_t i = axis; i < positions.size(); i += 3) positions[i] = 7;
    GltfBuilder gltf;
    gltf.add_mesh({{"attributes", {{"POSITION", gltf.add_positions(positions)}}}});
    gltf.add_node({{"mesh", 0}});
    const pack::Contents pack = gltf.bake();
    expect_separate(pack);
    expect_clipped(with_voxels(pack, kClip));
  }
}

TEST(Voxels, RefuseAGridThatNoFloatHolds) {
  GltfBuilder gltf = one_triangle();
  gltf.json["meshes"][0]["primitives"][0]["attributes"]["POSITION"] =
      gltf.add_positions({-3e38f, 0, 0, 3e38f, 0, 0, 0, 3.4e38f, 0});
  try {
    gltf.bake({.voxels = {{1, 1, 1}}});
    FAIL() << "baked";
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("too far apart for voxels"), std::string::npos) << error.what();
  }
}

TEST(Voxels, CarryTheTextureCoordinatesThatAMaskReads) {
  // A masked square of 4 m whose uv0 is (x, z) / 4 and whose uv1 is (z, x) / 8; an opaque one needs none.
  for (const int uv_set : {0, 1}) {
    GltfBuilder gltf;
    gltf.json["images"] = {{{"uri",
                             "data:image/png;base64,"
                             "iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAYAAAAfFcSJAAAADUlEQVR42mP8z8BQDwAEhQGAhKmMIQAAAABJRU5E"
                             "rkJggg=="}}};
    gltf.json["textures"] = {{{"source", 0}}};
    const Json map = {{"index", 0}, {"texCoord", uv_set}};
    gltf.json["materials"] = {{{"alphaMode", "MASK"}, {"pbrMetallicRoughness", {{"baseColorTexture", map}}}},
                              {{"pbrMetallicRoughness", {{"baseColorTexture", map}}}}};
    const int position = gltf.add_positions({0, 0, 0, 0, 0, 4, 4, 0, 0, 4, 0, 4});
    const int uv0 = gltf.add_floats({0, 0, 0, 1, 1, 0, 1, 1}, "VEC2", 2);
    const int uv1 = gltf.add_floats({0, 0, 0.5f, 0, 0, 0.5f, 0.5f, 0.5f}, "VEC2", 2);
    for (const int material : {0, 1}) {
      gltf.add_mesh({{"attributes", {{"POSITION", position}, {"TEXCOORD_0", uv0}, {"TEXCOORD_1", uv1}}},
                     {"indices", gltf.add_indices({0, 1, 2, 1, 3, 2})},
                     {"material", material}});
      gltf.add_node({{"mesh", material}, {"translation", {0, material * 2, 0}}});
    }
    const pack::Contents pack = gltf.bake({.voxels = {{5, 5, 5}, pack::VoxelMode::clip}});
    expect_clipped(pack);
    int masked = 0;
    for (const pack::VoxelRun& run : pack.voxel_runs) {
      for (std::uint32_t i = run.first_index; i < run.first_index + run.index_count; ++i) {
        const pack::VoxelVertex& v = pack.voxel_vertices[pack.voxel_indices[i].vertex];
        const bool mask = pack.materials[run.material].alpha_mode == pack::AlphaMode::mask;
        masked += mask;
        const float x = v.position_ws.x / 4, z = v.position_ws.z / 4;
        const glm::vec2 expected = !mask ? glm::vec2(0) : uv_set ? glm::vec2(z, x) / 2.0f : glm::vec2(x, z);
        EXPECT_NEAR(v.uv.x, expected.x, 1e-4);
        EXPECT_NEAR(v.uv.y, expected.y, 1e-4);
      }
    }
    EXPECT_GT(masked, 25 * 6);
  }
}

TEST(Voxels, KeepFrontsInFrontWhereTheyAreClipped) {
  // Mirrored instances too: normals of clipped parts point as the baked triangle's.
  GltfBuilder gltf = one_triangle();
  gltf.add_node({{"mesh", 0}, {"scale", {-1, 1, 1}}});
  const pack::Contents pack = gltf.bake({.voxels = {{7, 7, 7}, pack::VoxelMode::clip}});
  for (std::size_t i = 0; i < pack.voxel_indices.size(); i += 3) {
    const auto at = [&](std::size_t c) { return pack.voxel_vertices[pack.voxel_indices[i + c].vertex].position_ws; };
    EXPECT_GT(glm::cross(at(1) - at(0), at(2) - at(0)).z, 0);
  }
}

TEST(Voxels, HaveTheSameBytesOnAnyNumberOfThreads) {
  const GltfBuilder gltf = soup(20000, 7);
  for (const pack::VoxelMode mode : {pack::VoxelMode::separate, pack::VoxelMode::clip}) {
    const auto bake_with = [&](std::size_t threads) {
      const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
      return gltf.bake({.voxels = {{16, 16, 16}, mode}});
    };
    const pack::Contents one = bake_with(1), four = bake_with(4);
    const pack::View a = pack::view_of(one), b = pack::view_of(four);
    for (std::size_t i = 0; i < pack::section_infos.size(); ++i) {
      const auto left = pack::section_bytes(a, i), right = pack::section_bytes(b, i);
      ASSERT_EQ(left.size(), right.size());
      EXPECT_TRUE(left.empty() || std::memcmp(left.data(), right.data(), left.size()) == 0)
          << pack::section_infos[i].name;
    }
  }
}

class VoxelScenes : public testing::TestWithParam<const char*> {};

TEST_P(VoxelScenes, MissNoTriangleAndLoseNoArea) {
  const std::string path = GetParam();
  if (!std::filesystem::exists(std::string(CHANDELIER_DATA_DIR) + path)) GTEST_SKIP() << path << " is not here";
  const pack::Contents pack = bake_file(path);
  expect_separate(pack);
  expect_clipped(with_voxels(pack, kClip));
}

INSTANTIATE_TEST_SUITE_P(Each, VoxelScenes,
                         testing::Values("/scenes/crytek_sponza/crytek_sponza.gltf",
                                         "/scenes/nexuiz_stormkeep/stormkeep.gltf",
                                         "/scenes/cornell_box/CornellBox-Original.gltf"));

}  // namespace
}  // namespace chandelier::baker::test
