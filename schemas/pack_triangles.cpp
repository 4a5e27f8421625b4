// SPDX-License-Identifier: Apache-2.0
// Corners of triangles in meshoptimizer's index code: the content of sections with the codec triangles, before zstd.
#include "pack_triangles.h"

#include <cstring>

#ifndef CHANDELIER_PORTABLE
#include <meshoptimizer.h>
#endif

namespace chandelier::pack {

#ifdef CHANDELIER_PORTABLE

bool has_triangle_codec() {
  return false;
}

std::vector<std::byte> to_triangle_code(std::span<const uint32_t>, uint32_t) {
  return {};
}

bool from_triangle_code(std::span<const std::byte>, std::span<uint32_t>) {
  return false;
}

size_t triangle_code_bound(size_t) {
  return 0;
}

#else

namespace {

// Allows any vertex number. The library computes the longest code of a number from it.
constexpr size_t vertices = 0xFFFFFFFF;

/// Calls `visit(triangle, turn)` with the turn that the code gives each triangle: corner k of the input is corner
/// (k + turn) % 3 of `coded`. A triangle with equal corners may fit more than one; the first is taken.
template <typename Visit>
void for_each_turn(std::span<const uint32_t> corners, std::span<const uint32_t> coded, Visit visit) {
  for (size_t t = 0; t < corners.size() / 3; ++t) {
    const uint32_t *from = &corners[3 * t], *to = &coded[3 * t];
    uint8_t turn = 0;
    while (turn < 2 && (from[0] != to[turn] || from[1] != to[(turn + 1) % 3] || from[2] != to[(turn + 2) % 3])) ++turn;
    visit(t, turn);
  }
}

}  // namespace

bool has_triangle_codec() {
  return true;
}

size_t triangle_code_bound(size_t corner_count) {
  return sizeof(uint32_t) + corner_count / 3 + meshopt_encodeIndexBufferBound(corner_count, vertices);
}

std::vector<std::byte> to_triangle_code(std::span<const uint32_t> corners, uint32_t base) {
  const size_t count = corners.size(), head = sizeof(base) + count / 3;
  std::vector<uint32_t> moved(corners.begin(), corners.end());
  for (uint32_t& corner : moved) corner -= base;
  std::vector<std::byte> coded(triangle_code_bound(count));
  std::memcpy(coded.data(), &base, sizeof(base));
  auto* code = reinterpret_cast<unsigned char*>(coded.data() + head);
  const size_t code_bytes = meshopt_encodeIndexBuffer(code, coded.size() - head, moved.data(), count);
  std::vector<uint32_t> turned(count);
  if (code_bytes == 0 || meshopt_decodeIndexBuffer(turned.data(), count, sizeof(base), code, code_bytes) != 0)
    return {};
  for_each_turn(moved, turned, [&](size_t t, uint8_t turn) { coded[sizeof(base) + t] = std::byte{turn}; });
  coded.resize(head + code_bytes);
  return coded;
}

bool from_triangle_code(std::span<const std::byte> coded, std::span<uint32_t> corners) {
  uint32_t base = 0;
  const size_t head = sizeof(base) + corners.size() / 3;
  if (coded.size() <= head) return false;
  std::memcpy(&base, coded.data(), sizeof(base));
  const auto* code = reinterpret_cast<const unsigned char*>(coded.data() + head);
  if (meshopt_decodeIndexBuffer(corners.data(), corners.size(), sizeof(base), code, coded.size() - head) != 0) {
    return false;
  }
  for (size_t t = 0; t < corners.size() / 3; ++t) {
    const auto turn = static_cast<uint32_t>(coded[sizeof(base) + t]);
    if (turn > 2) return false;
    const uint32_t was[3] = {corners[3 * t], corners[3 * t + 1], corners[3 * t + 2]};
    for (uint32_t k = 0; k < 3; ++k) corners[3 * t + k] = was[(k + turn) % 3] + base;
  }
  return true;
}

#endif

}  // namespace chandelier::pack
