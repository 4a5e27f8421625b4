// SPDX-License-Identifier: Apache-2.0
// Clean and shells: cubes whose answer is known, and heaps of triangles against OpenMesh.
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <OpenMesh/Core/Mesh/TriMesh_ArrayKernelT.hh>
#include <algorithm>
#include <map>
#include <random>
#include <set>

#include "bake/clean.h"
#include "bake/shells.h"

namespace chandelier::baker::test {
namespace {

using Corners = std::vector<uint32_t>;

const std::vector<Material> materials = [] {
  std::vector<Material> out(2);
  out[1].masked = true;
  return out;
}();

PackedPrimitive primitive_of(const std::vector<glm::vec3>& places, const Corners& corners) {
  PackedPrimitive out;
  for (const glm::vec3& place : places) out.vertices.push_back({.position_ls = place, .attributes = {}});
  out.indices = corners;
  return out;
}

/// The unit cube from `at`: two triangles a side, fronts outwards; each triangle with vertices of its own.
PackedPrimitive cube(const glm::vec3& at, size_t triangles = 12, bool inside_out = false) {
  PackedPrimitive out;
  for (int side = 0; side < 6; ++side) {
    const int axis = side / 2, u = (axis + 1) % 3, v = (axis + 2) % 3;
    glm::vec3 corner[4];
    for (int i = 0; i < 4; ++i) {
      corner[i] = at;
      corner[i][axis] += static_cast<float>(side % 2);
      corner[i][u] += static_cast<float>(i == 1 || i == 2);
      corner[i][v] += static_cast<float>(i >= 2);
    }
    if ((side % 2 == 0) != inside_out) std::swap(corner[1], corner[3]);
    for (const int i : {0, 1, 2, 0, 2, 3}) {
      out.indices.push_back(static_cast<uint32_t>(out.vertices.size()));
      out.vertices.push_back({.position_ls = corner[i], .attributes = {}});
    }
  }
  out.indices.resize(3 * triangles);
  return out;
}

ShellCounts shells_of(std::vector<PackedPrimitive> primitives, bool rigid = true) {
  PackedMesh mesh{std::move(primitives)};
  return find_shells(mesh, materials, rigid);
}

TEST(Shells, ACubeIsClosed) {
  const ShellCounts counts = shells_of({cube({5, 0, -2})});
  EXPECT_EQ(counts.shells, 1u);
  EXPECT_EQ(counts.closed, 1u);
  EXPECT_EQ(counts.closed_triangles, 12u);
}

TEST(Shells, ABoxWithAHoleIsOpen) {
  for (const size_t triangles : {11u, 10u}) {
    EXPECT_EQ(shells_of({cube({}, triangles)}).shells, 1u);
    EXPECT_EQ(shells_of({cube({}, triangles)}).closed, 0u);
  }
}

TEST(Shells, ACubeInsideOutIsNotClosedOutwards) {
  EXPECT_EQ(shells_of({cube({3, 3, 3}, 12, true)}).closed, 0u);
}

TEST(Shells, ACubeWithOneTriangleTurnedIsNotOriented) {
  PackedPrimitive turned = cube({});
  std::swap(turned.indices[0], turned.indices[1]);
  EXPECT_EQ(shells_of({turned}).closed, 0u);
}

TEST(Shells, CubesThatShareAnEdgeAreOneShellThatIsNotClosed) {
  const ShellCounts counts = shells_of({cube({}), cube({1, 1, 0})});
  EXPECT_EQ(counts.shells, 1u);
  EXPECT_EQ(counts.closed, 0u);
}

TEST(Shells, CubesThatShareACornerAreTwoAndClosed) {
  EXPECT_EQ(shells_of({cube({}), cube({1, 1, 1})}).closed, 2u);
}

TEST(Shells, ReachOverPrimitives) {
  PackedPrimitive top = cube({}), rest = cube({});
  rest.indices.erase(rest.indices.begin(), rest.indices.begin() + 6);
  top.indices.resize(6);
  EXPECT_EQ(shells_of({top, rest}).closed, 1u);
  EXPECT_EQ(shells_of({top, rest}).closed_triangles, 12u);
  top.material = 1;  // masked: one sees into the box
  EXPECT_EQ(shells_of({top, rest}).closed, 0u);
}

TEST(Shells, OfWhatASkinBendsAreOpen) {
  EXPECT_EQ(shells_of({cube({})}, false).closed_triangles, 0u);
}

TEST(Shells, ATriangleWithItsOwnBackEnclosesNothing) {
  const std::vector<glm::vec3> places = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  EXPECT_EQ(shells_of({primitive_of(places, {0, 1, 2, 0, 2, 1})}).closed, 0u);
}

/// A dozen places and as many triangles as asked, without an area or not.
PackedPrimitive heap(std::mt19937& random, size_t triangles, size_t place_count) {
  std::vector<glm::vec3> places;
  for (size_t i = 0; i < place_count; ++i) {
    places.push_back(
        {static_cast<float>(random() % 5), static_cast<float>(random() % 5), static_cast<float>(random() % 5)});
  }
  Corners corners;
  for (size_t i = 0; i < 3 * triangles; ++i) corners.push_back(static_cast<uint32_t>(random() % place_count));
  return primitive_of(places, corners);
}

using Triangle = std::array<std::array<float, 3>, 3>;

Triangle turned(const PackedPrimitive& primitive, size_t t) {
  Triangle out;
  for (size_t c = 0; c < 3; ++c) {
    const glm::vec3& p = corner_of(primitive, t, c);
    out[c] = {p.x, p.y, p.z};
  }
  std::rotate(out.begin(), std::min_element(out.begin(), out.end()), out.end());
  return out;
}

TEST(Clean, KeepsTheFirstOfEachTriangleWithAnArea) {
  std::mt19937 random(3);
  for (int round = 0; round < 100; ++round) {
    PackedMesh mesh{{heap(random, 200, 12), heap(random, 50, 8)}};
    mesh.primitives[1].material = static_cast<uint32_t>(round % 2);
    std::vector<std::pair<Triangle, uint32_t>> expected, kept;  // with the material
    std::set<std::pair<Triangle, uint32_t>> seen;
    uint64_t degenerate = 0, duplicate = 0;
    const auto each = [&](auto use) {
      for (const PackedPrimitive& primitive : mesh.primitives) {
        for (size_t t = 0; t < primitive.triangle_count(); ++t) use(primitive, t);
      }
    };
    each([&](const PackedPrimitive& primitive, size_t t) {
      const std::pair key(turned(primitive, t), primitive.material);
      const bool flat = glm::length(area_vector(primitive, t)) < 1e-9;
      degenerate += flat;
      if (flat) return;
      if (seen.insert(key).second) {
        expected.push_back(key);
      } else {
        ++duplicate;
      }
    });
    const CleanCounts counts = clean(mesh, materials, true);
    each([&](const PackedPrimitive& primitive, size_t t) {
      kept.emplace_back(turned(primitive, t), primitive.material);
    });
    EXPECT_EQ(kept, expected);
    EXPECT_EQ(counts.degenerate, degenerate);
    EXPECT_EQ(counts.duplicate, duplicate);
  }
}

/// Two triangles in the same place, each with vertices of its own.
PackedMesh twins(uint32_t material) {
  PackedPrimitive one = primitive_of({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {0, 1, 2});
  one.vertices.insert(one.vertices.end(), one.vertices.begin(), one.vertices.begin() + 3);
  one.indices = {0, 1, 2, 3, 4, 5};
  one.material = material;
  return {{one}};
}

TEST(Clean, KeepsWhatASkinMayPullApart) {
  PackedMesh mesh = twins(0);
  mesh.primitives[0].vertices.push_back({{2, 0, 0}, {}});
  mesh.primitives[0].indices.insert(mesh.primitives[0].indices.end(), {0, 1, 6, 0, 1, 1});  // flat, and without a third
  const CleanCounts counts = clean(mesh, materials, false);
  EXPECT_EQ(counts.duplicate, 0u);
  EXPECT_EQ(counts.degenerate, 1u);
  EXPECT_EQ(mesh.primitives[0].indices, (std::vector<uint32_t>{0, 1, 2, 3, 4, 5, 0, 1, 6}));
}

TEST(Clean, TellsMaskedTrianglesApartByWhatTheirAlphaDependsOn) {
  constexpr uint32_t opaque_material = 0, masked_material = 1;
  for (const int change : {0, 1, 2, 3}) {
    for (const uint32_t material : {opaque_material, masked_material}) {
      PackedMesh mesh = twins(material);
      pack::VertexAttributes& other = mesh.primitives[0].vertices[4].attributes;
      if (change == 1) other.uv0.y += 0.5f;
      if (change == 2) other.uv1.x += 0.5f;
      if (change == 3) other.color ^= 0x80000000u;
      ASSERT_EQ(materials[material].masked, material == masked_material);
      const bool kept = change > 0 && material == masked_material;
      EXPECT_EQ(clean(mesh, materials, true).duplicate, kept ? 0u : 1u) << change << " " << material;
    }
  }
}

using HalfedgeMesh = OpenMesh::TriMesh_ArrayKernelT<>;

/// Shells by OpenMesh, or nothing where it cannot hold the mesh: how many, and how many of them are closed and face
/// outwards. An edge that only touches itself in places still has one halfedge each way; OpenMesh refuses anything
/// else.
std::optional<ShellCounts> shells_by_openmesh(const PackedPrimitive& primitive) {
  omerr().disable();
  HalfedgeMesh mesh;
  std::map<std::array<float, 3>, HalfedgeMesh::VertexHandle> handles;
  const auto handle = [&](const glm::vec3& p) {
    const auto [it, added] = handles.try_emplace({p.x, p.y, p.z});
    if (added) it->second = mesh.add_vertex({p.x, p.y, p.z});
    return it->second;
  };
  for (size_t t = 0; t < primitive.triangle_count(); ++t) {
    if (!mesh.add_face(handle(corner_of(primitive, t, 0)), handle(corner_of(primitive, t, 1)),
                       handle(corner_of(primitive, t, 2)))
             .is_valid()) {
      return std::nullopt;
    }
  }
  ShellCounts counts;
  std::vector<bool> visited(mesh.n_faces(), false);
  for (const auto start : mesh.faces()) {
    if (visited[static_cast<size_t>(start.idx())]) continue;
    std::vector<OpenMesh::FaceHandle> stack = {start};
    visited[static_cast<size_t>(start.idx())] = true;
    bool closed = true;
    double volume = 0;
    while (!stack.empty()) {
      const OpenMesh::FaceHandle face = stack.back();
      stack.pop_back();
      glm::dvec3 p[3];
      int corner = 0;
      for (const auto vertex : mesh.fv_range(face)) {
        const auto at = mesh.point(vertex);
        p[corner++] = {at[0], at[1], at[2]};
      }
      volume += glm::dot(p[0], glm::cross(p[1], p[2]));
      for (const auto h : mesh.fh_range(face)) {
        const auto across = mesh.opposite_halfedge_handle(h);
        if (mesh.is_boundary(across)) {
          closed = false;
          continue;
        }
        const auto next = static_cast<size_t>(mesh.face_handle(across).idx());
        if (!visited[next]) stack.push_back(mesh.face_handle(across));
        visited[next] = true;
      }
    }
    ++counts.shells;
    counts.closed += closed && volume > 1e-9;
  }
  return counts;
}

TEST(Shells, AgreeWithOpenMeshWhereItHoldsTheMesh) {
  std::mt19937 random(11);
  int compared = 0, closed = 0;
  for (int round = 0; round < 3000; ++round) {
    PackedPrimitive primitive;
    if (round % 3 == 0) {  // a few triangles over a few places
      primitive = heap(random, 2 + random() % 5, 5 + random() % 12);
    } else {  // cubes here and there, each perhaps with a hole or inside out
      for (int i = 0; i < 4; ++i) {
        const glm::vec3 at(static_cast<float>(random() % 5), static_cast<float>(random() % 5),
                           static_cast<float>(random() % 5));
        const PackedPrimitive one = cube(2.0f * at, 12 - random() % 2, random() % 4 == 0);
        const auto base = static_cast<uint32_t>(primitive.vertices.size());
        primitive.vertices.insert(primitive.vertices.end(), one.vertices.begin(), one.vertices.end());
        for (const uint32_t index : one.indices) primitive.indices.push_back(base + index);
      }
    }
    PackedMesh mesh{{primitive}};
    clean(mesh, materials, true);
    const auto expected = shells_by_openmesh(mesh.primitives[0]);
    const ShellCounts counts = find_shells(mesh, materials, true);  // must not fail either way
    if (!expected) continue;
    ++compared;
    closed += static_cast<int>(expected->closed);
    EXPECT_EQ(counts.shells, expected->shells) << round;
    EXPECT_EQ(counts.closed, expected->closed) << round;
  }
  EXPECT_GT(compared, 500);
  EXPECT_GT(closed, 500);
}

TEST(Shells, OfManyCubesAreTheSameOnAnyNumberOfThreads) {
  // Enough triangles to be filed in parts; every other cube is open.
  PackedMesh mesh{{PackedPrimitive()}};
  PackedPrimitive& all = mesh.primitives[0];
  for (int i = 0; i < 8000; ++i) {
    const PackedPrimitive one =
        cube({3.0f * static_cast<float>(i % 90), 3.0f * static_cast<float>(i / 90), 0}, i % 2 ? 12 : 11);
    const auto base = static_cast<uint32_t>(all.vertices.size());
    all.vertices.insert(all.vertices.end(), one.vertices.begin(), one.vertices.end());
    for (const uint32_t index : one.indices) all.indices.push_back(base + index);
  }
  std::vector<bool> closed[2];
  for (const size_t threads : {1u, 2u}) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    PackedMesh copy = mesh;
    EXPECT_EQ(find_shells(copy, materials, true).closed, 4000u);
    closed[threads - 1] = copy.primitives[0].closed;
  }
  EXPECT_EQ(closed[0], closed[1]);
}

}  // namespace
}  // namespace chandelier::baker::test
