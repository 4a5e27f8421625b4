// SPDX-License-Identifier: Apache-2.0
// Welds only equal vertices: quantization has made nearly equal ones equal.
#include "weld.h"

#include <cstring>

#include "equal.h"

namespace chandelier::baker {
namespace {

template <typename Record>
uint32_t hash_of(const Record& record) {
  static_assert(sizeof(Record) % sizeof(uint32_t) == 0);
  uint32_t words[sizeof(Record) / sizeof(uint32_t)];
  std::memcpy(words, &record, sizeof(Record));
  return hash_words(words, std::size(words));
}

template <typename Record>
bool same(const Record& a, const Record& b) {
  return std::memcmp(&a, &b, sizeof(Record)) == 0;
}

/// Works on both stages' primitives, whose members have the same names.
template <typename AnyPrimitive>
void weld_any(AnyPrimitive& primitive) {
  auto& vertices = primitive.vertices;
  auto& skin = primitive.skin_vertices;
  const bool skinned = !skin.empty();
  std::vector<uint32_t> number = first_equal(
      vertices.size(),
      [&](size_t i) {
        return skinned ? hash_of(vertices[i]) ^ (hash_of(skin[i]) * 0x9E3779B1u) : hash_of(vertices[i]);
      },
      [&](size_t i, size_t j) { return same(vertices[i], vertices[j]) && (!skinned || same(skin[i], skin[j])); });
  uint32_t kept = 0;
  for (size_t i = 0; i < number.size(); ++i) {
    if (number[i] < i) {
      number[i] = number[number[i]];  // the first one's, which has its new number already
      continue;
    }
    vertices[kept] = vertices[i];
    if (skinned) skin[kept] = skin[i];
    number[i] = kept++;
  }
  vertices.resize(kept);
  if (skinned) skin.resize(kept);
  for (uint32_t& index : primitive.indices) index = number[index];
}

}  // namespace

void weld(Primitive& primitive) {
  weld_any(primitive);
}

void weld(PackedPrimitive& primitive) {
  weld_any(primitive);
}

}  // namespace chandelier::baker
