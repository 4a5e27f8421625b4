// SPDX-License-Identifier: Apache-2.0
// Edges are sorted by their lower end. OpenMesh's halfedges would take 220 ns per triangle on one core, a third of the
// time for the whole bake; the tests compare the two.
#include "shells.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cstddef>

#include "clean.h"

namespace chandelier::baker {
namespace {

using Places = std::array<uint32_t, 3>;

std::vector<Places> triangle_places(const PackedMesh& mesh) {
  const std::vector<uint32_t> places = places_of(mesh);
  std::vector<Places> out;
  size_t count = 0, base = 0;
  for (const PackedPrimitive& primitive : mesh.primitives) count += primitive.triangle_count();
  out.reserve(count);
  for (const PackedPrimitive& primitive : mesh.primitives) {
    for (size_t i = 0; i < primitive.indices.size(); i += 3) {
      const uint32_t* corner = &primitive.indices[i];
      out.push_back({places[base + corner[0]], places[base + corner[1]], places[base + corner[2]]});
    }
    base += primitive.vertices.size();
  }
  return out;
}

/// Connected triangles: a forest whose roots are the lowest numbers, in whatever order threads unite them. (Anderson
/// and Woll 1991, Wait-free parallel algorithms for the union-find problem.)
class Forest {
 public:
  explicit Forest(size_t count) : parent_(count) {
    for (size_t i = 0; i < count; ++i) parent_[i] = static_cast<uint32_t>(i);
  }

  uint32_t root(uint32_t i) {
    while (true) {
      const uint32_t parent = load(i);
      if (parent == i) return i;
      const uint32_t grandparent = load(parent);
      if (grandparent != parent) std::atomic_ref(parent_[i]).store(grandparent, std::memory_order_relaxed);
      i = grandparent;
    }
  }

  void unite(uint32_t a, uint32_t b) {
    while (true) {
      a = root(a);
      b = root(b);
      if (a == b) return;
      if (a < b) std::swap(a, b);
      uint32_t expected = a;
      if (std::atomic_ref(parent_[a]).compare_exchange_strong(expected, b, std::memory_order_relaxed)) return;
    }
  }

 private:
  uint32_t load(uint32_t i) { return std::atomic_ref(parent_[i]).load(std::memory_order_relaxed); }

  std::vector<uint32_t> parent_;
};

/// One side of a triangle, filed under the lower of its two ends.
struct Side {
  uint32_t upper;          // the other end
  uint32_t triangle_down;  // 2 · triangle, + 1 where it runs from the upper end to the lower
};

/// The sides whose lower ends are in [begin, end), filed by it.
class Sides {
 public:
  Sides(const std::vector<Places>& triangles, uint32_t begin, uint32_t end) : start_(end - begin + 1, 0) {
    const auto each = [&](auto use) {
      for (size_t t = 0; t < triangles.size(); ++t) {
        for (size_t c = 0; c < 3; ++c) {
          const uint32_t from = triangles[t][c], to = triangles[t][(c + 1) % 3];
          const uint32_t lower = std::min(from, to) - begin;
          if (lower < end - begin) use(lower, Side{std::max(from, to), static_cast<uint32_t>(2 * t + (from > to))});
        }
      }
    };
    each([&](uint32_t lower, Side) { ++start_[lower + 1]; });
    for (size_t i = 1; i < start_.size(); ++i) start_[i] += start_[i - 1];
    sides_.resize(start_.back());
    each([&](uint32_t lower, Side side) { sides_[start_[lower]++] = side; });  // start_ is now the end of each
  }

  /// Calls `edge(first, last)` for the sides of each edge, in the order of triangles.
  template <typename Edge>
  void for_each_edge(Edge edge) {
    size_t begin = 0;
    for (size_t i = 0; i + 1 < start_.size(); ++i) {
      const auto first = sides_.begin() + static_cast<ptrdiff_t>(begin);
      const auto last = sides_.begin() + static_cast<ptrdiff_t>(begin = start_[i]);
      std::sort(first, last, [](const Side& a, const Side& b) {
        return a.upper != b.upper ? a.upper < b.upper : a.triangle_down < b.triangle_down;
      });
      for (auto from = first; from < last;) {
        auto to = from + 1;
        while (to < last && to->upper == from->upper) ++to;
        edge(from, to);
        from = to;
      }
    }
  }

 private:
  std::vector<size_t> start_;
  std::vector<Side> sides_;
};

/// Unites triangles over edges, and marks one at each edge where the surface is not closed.
void walk_edges(const std::vector<Places>& triangles, size_t place_count, Forest& forest, std::vector<uint8_t>& open) {
  const size_t parts = triangles.size() > 50000 ? 4 : 1;  // each reads all triangles, and keeps its own sides
  tbb::parallel_for(size_t{0}, parts, [&](size_t part) {
    Sides sides(triangles, static_cast<uint32_t>(place_count * part / parts),
                static_cast<uint32_t>(place_count * (part + 1) / parts));
    sides.for_each_edge([&](auto first, auto last) {
      for (auto other = first + 1; other < last; ++other) {
        forest.unite(first->triangle_down / 2, other->triangle_down / 2);
      }
      const bool closed = last - first == 2 && (first->triangle_down ^ (first + 1)->triangle_down) % 2 == 1;
      if (!closed) std::atomic_ref(open[first->triangle_down / 2]).store(1, std::memory_order_relaxed);
    });
  });
}

/// Triangles of a mesh in a row, whatever their primitive.
template <typename Use>
void for_each_triangle(PackedMesh& mesh, Use use) {
  uint32_t number = 0;
  for (PackedPrimitive& primitive : mesh.primitives) {
    for (size_t t = 0; t < primitive.triangle_count(); ++t) use(number++, primitive, t);
  }
}

}  // namespace

ShellCounts find_shells(PackedMesh& mesh, const std::vector<Material>& materials, bool rigid) {
  for (PackedPrimitive& primitive : mesh.primitives) primitive.closed.assign(primitive.triangle_count(), false);
  if (!rigid) return {};
  size_t place_count = 0;
  for (const PackedPrimitive& primitive : mesh.primitives) place_count += primitive.vertices.size();
  const std::vector<Places> triangles = triangle_places(mesh);
  Forest forest(triangles.size());
  std::vector<uint8_t> open(triangles.size(), 0);
  walk_edges(triangles, place_count, forest, open);

  for_each_triangle(mesh, [&](uint32_t number, const PackedPrimitive& primitive, size_t) {
    const Material& material = materials[primitive.material];
    if (open[number] || material.masked || material.shadowless) open[forest.root(number)] = 1;
  });
  struct Shell {
    glm::dvec3 origin{0};
    double volume = 0;  // six times
  };
  std::vector<Shell> shells;
  std::vector<uint32_t> shell_of(triangles.size(), no_index);  // of roots
  ShellCounts counts;
  for_each_triangle(mesh, [&](uint32_t number, const PackedPrimitive& primitive, size_t t) {
    const uint32_t root = forest.root(number);
    counts.shells += root == number;
    if (open[root]) return;
    if (root == number) {  // the lowest number of its triangles, so it comes first
      shell_of[root] = static_cast<uint32_t>(shells.size());
      shells.push_back({corner_of(primitive, t, 0)});
    }
    Shell& shell = shells[shell_of[root]];
    shell.volume += glm::dot(glm::dvec3(corner_of(primitive, t, 0)) - shell.origin, area_vector(primitive, t));
  });
  for (const Shell& shell : shells) counts.closed += shell.volume > 0;
  for_each_triangle(mesh, [&](uint32_t number, PackedPrimitive& primitive, size_t t) {
    const uint32_t root = forest.root(number);
    if (open[root] || !(shells[shell_of[root]].volume > 0)) return;
    primitive.closed[t] = true;
    ++counts.closed_triangles;
  });
  return counts;
}

}  // namespace chandelier::baker
