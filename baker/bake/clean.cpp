// SPDX-License-Identifier: Apache-2.0
// Degenerate and duplicate triangles.
#include "clean.h"

#include <array>
#include <cstring>

#include "equal.h"

namespace chandelier::baker {
namespace {

/// A triangle's corners, from the smallest on, so that it is the same whatever corner it starts with, and its material.
using Key = std::array<uint32_t, 4>;

Key key_of(uint32_t a, uint32_t b, uint32_t c, uint32_t material) {
  if (b < a && b < c) return {b, c, a, material};
  if (c < a && c < b) return {c, a, b, material};
  return {a, b, c, material};
}

bool has_vertex_twice(const uint32_t* corner) {
  return corner[0] == corner[1] || corner[1] == corner[2] || corner[2] == corner[0];
}

uint64_t drop_degenerate(PackedPrimitive& primitive, bool rigid) {
  const size_t count = primitive.triangle_count();
  size_t kept = 0;
  for (size_t t = 0; t < count; ++t) {
    if (has_vertex_twice(&primitive.indices[3 * t])) continue;
    if (rigid && area_vector(primitive, t) == glm::dvec3(0)) continue;
    if (kept < t) std::copy_n(&primitive.indices[3 * t], 3, &primitive.indices[3 * kept]);
    ++kept;
  }
  primitive.indices.resize(3 * kept);
  return count - kept;
}

/// Drops the triangles of a primitive for which `first` names an earlier triangle. They are numbered from `base`.
uint64_t drop_repeated(PackedPrimitive& primitive, const std::vector<uint32_t>& first, size_t base) {
  const size_t count = primitive.triangle_count();
  size_t kept = 0;
  for (size_t t = 0; t < count; ++t) {
    if (first[base + t] < base + t) continue;
    if (kept < t) std::copy_n(&primitive.indices[3 * t], 3, &primitive.indices[3 * kept]);
    ++kept;
  }
  primitive.indices.resize(3 * kept);
  return count - kept;
}

std::vector<Key> keys_of(const PackedMesh& mesh, const std::vector<uint32_t>& corners) {
  size_t count = 0;
  for (const PackedPrimitive& primitive : mesh.primitives) count += primitive.triangle_count();
  std::vector<Key> keys;
  keys.reserve(count);
  size_t base = 0;
  for (const PackedPrimitive& primitive : mesh.primitives) {
    for (size_t i = 0; i < primitive.indices.size(); i += 3) {
      keys.push_back(key_of(corners[base + primitive.indices[i]], corners[base + primitive.indices[i + 1]],
                            corners[base + primitive.indices[i + 2]], primitive.material));
    }
    base += primitive.vertices.size();
  }
  return keys;
}

/// Vertices of all primitives of a mesh in a row.
class Vertices {
 public:
  explicit Vertices(const PackedMesh& mesh) : mesh_(mesh) {
    size_t count = 0;
    for (const PackedPrimitive& primitive : mesh.primitives) ends_.push_back(count += primitive.vertices.size());
  }

  size_t size() const { return ends_.empty() ? 0 : ends_.back(); }
  size_t primitive_of(size_t i) const {
    if (ends_.size() == 1) return 0;
    return static_cast<size_t>(std::upper_bound(ends_.begin(), ends_.end(), i) - ends_.begin());
  }
  const PackedVertex& operator[](size_t i) const {
    const size_t p = primitive_of(i);
    return mesh_.primitives[p].vertices[i - (p == 0 ? 0 : ends_[p - 1])];
  }

 private:
  const PackedMesh& mesh_;
  std::vector<size_t> ends_;
};

uint32_t hash_of(const glm::vec3& position) {
  const glm::vec3 p = position + 0.0f;  // -0 is 0
  uint32_t words[3];
  std::memcpy(words, &p, sizeof(words));
  return hash_words(words, 3);
}

/// What an alpha test depends on.
bool has_equal_alpha(const pack::VertexAttributes& a, const pack::VertexAttributes& b) {
  return a.uv0 == b.uv0 && a.uv1 == b.uv1 && a.color == b.color;
}

/// Like places_of, but in masked primitives vertices also differ if an alpha test may give different results for them.
std::vector<uint32_t> corners_of(const PackedMesh& mesh, const std::vector<Material>& materials) {
  const Vertices vertices(mesh);
  const auto is_masked = [&](size_t i) { return materials[mesh.primitives[vertices.primitive_of(i)].material].masked; };
  return first_equal(
      vertices.size(), [&](size_t i) { return hash_of(vertices[i].position_ls) + is_masked(i); },
      [&](size_t i, size_t j) {
        if (vertices[i].position_ls != vertices[j].position_ls || is_masked(i) != is_masked(j)) return false;
        return !is_masked(i) || has_equal_alpha(vertices[i].attributes, vertices[j].attributes);
      });
}

}  // namespace

std::vector<uint32_t> places_of(const PackedMesh& mesh) {
  const Vertices vertices(mesh);
  return first_equal(
      vertices.size(), [&](size_t i) { return hash_of(vertices[i].position_ls); },
      [&](size_t i, size_t j) { return vertices[i].position_ls == vertices[j].position_ls; });
}

CleanCounts clean(PackedMesh& mesh, const std::vector<Material>& materials, bool rigid) {
  CleanCounts counts;
  for (PackedPrimitive& primitive : mesh.primitives) counts.degenerate += drop_degenerate(primitive, rigid);
  if (!rigid) return counts;
  const bool masked = std::any_of(mesh.primitives.begin(), mesh.primitives.end(),
                                  [&](const PackedPrimitive& each) { return materials[each.material].masked; });
  const std::vector<Key> keys = keys_of(mesh, masked ? corners_of(mesh, materials) : places_of(mesh));
  const std::vector<uint32_t> first = first_equal(
      keys.size(), [&](size_t i) { return hash_words(keys[i].data(), keys[i].size()); },
      [&](size_t i, size_t j) { return keys[i] == keys[j]; });
  size_t base = 0;
  for (PackedPrimitive& primitive : mesh.primitives) {
    const size_t count = primitive.triangle_count();
    counts.duplicate += drop_repeated(primitive, first, base);
    base += count;
  }
  return counts;
}

}  // namespace chandelier::baker
