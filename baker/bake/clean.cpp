// SPDX-License-Identifier: Apache-2.0
// Degenerate and duplicate triangles.
#include "clean.h"

#include <array>
#include <cstring>

#include "equal.h"

namespace chandelier::baker {
namespace {

/// A triangle's places, from the smallest on, so that it is the same whatever corner it starts with, and its material.
using Key = std::array<std::uint32_t, 4>;

Key key_of(std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t material) {
  if (b < a && b < c) return {b, c, a, material};
  if (c < a && c < b) return {c, a, b, material};
  return {a, b, c, material};
}

std::uint64_t drop_degenerate(PackedPrimitive& primitive) {
  const std::size_t count = primitive.triangle_count();
  std::size_t kept = 0;
  for (std::size_t t = 0; t < count; ++t) {
    if (area_vector(primitive, t) == glm::dvec3(0)) continue;
    if (kept < t) std::copy_n(&primitive.indices[3 * t], 3, &primitive.indices[3 * kept]);
    ++kept;
  }
  primitive.indices.resize(3 * kept);
  return count - kept;
}

/// Drops those of a primitive's triangles that `first` numbers below themselves; they are counted from `base`.
std::uint64_t drop_repeated(PackedPrimitive& primitive, const std::vector<std::uint32_t>& first, std::size_t base) {
  const std::size_t count = primitive.triangle_count();
  std::size_t kept = 0;
  for (std::size_t t = 0; t < count; ++t) {
    if (first[base + t] < base + t) continue;
    if (kept < t) std::copy_n(&primitive.indices[3 * t], 3, &primitive.indices[3 * kept]);
    ++kept;
  }
  primitive.indices.resize(3 * kept);
  return count - kept;
}

std::vector<Key> keys_of(const PackedMesh& mesh, const std::vector<std::uint32_t>& places) {
  std::size_t count = 0;
  for (const PackedPrimitive& primitive : mesh.primitives) count += primitive.triangle_count();
  std::vector<Key> keys;
  keys.reserve(count);
  std::size_t base = 0;
  for (const PackedPrimitive& primitive : mesh.primitives) {
    for (std::size_t i = 0; i < primitive.indices.size(); i += 3) {
      keys.push_back(key_of(places[base + primitive.indices[i]], places[base + primitive.indices[i + 1]],
                            places[base + primitive.indices[i + 2]], primitive.material));
    }
    base += primitive.vertices.size();
  }
  return keys;
}

}  // namespace

std::vector<std::uint32_t> places_of(const PackedMesh& mesh) {
  std::vector<std::size_t> ends;
  std::size_t count = 0;
  for (const PackedPrimitive& primitive : mesh.primitives) ends.push_back(count += primitive.vertices.size());
  const auto position = [&](std::size_t i) -> const glm::vec3& {
    std::size_t p = 0;
    if (ends.size() > 1) p = static_cast<std::size_t>(std::upper_bound(ends.begin(), ends.end(), i) - ends.begin());
    return mesh.primitives[p].vertices[i - (p == 0 ? 0 : ends[p - 1])].position_ls;
  };
  return first_equal(
      count,
      [&](std::size_t i) {
        const glm::vec3 p = position(i) + 0.0f;  // -0 is 0
        std::uint32_t words[3];
        std::memcpy(words, &p, sizeof(words));
        return hash_words(words, 3);
      },
      [&](std::size_t i, std::size_t j) { return position(i) == position(j); });
}

CleanCounts clean(PackedMesh& mesh) {
  CleanCounts counts;
  for (PackedPrimitive& primitive : mesh.primitives) counts.degenerate += drop_degenerate(primitive);
  const std::vector<Key> keys = keys_of(mesh, places_of(mesh));
  const std::vector<std::uint32_t> first = first_equal(
      keys.size(), [&](std::size_t i) { return hash_words(keys[i].data(), keys[i].size()); },
      [&](std::size_t i, std::size_t j) { return keys[i] == keys[j]; });
  std::size_t base = 0;
  for (PackedPrimitive& primitive : mesh.primitives) {
    const std::size_t count = primitive.triangle_count();
    counts.duplicate += drop_repeated(primitive, first, base);
    base += count;
  }
  return counts;
}

}  // namespace chandelier::baker
