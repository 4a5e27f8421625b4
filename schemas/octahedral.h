// SPDX-License-Identifier: Apache-2.0
// Unit vectors in 32 bits, as VertexAttributes stores them.
// Cigolle et al. 2014, A Survey of Efficient Representations for Independent Unit Vectors.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

namespace chandelier::pack {

/// -1..1 on the unfolded octahedron.
inline glm::vec2 octahedral(const glm::vec3& n) {
  const glm::vec2 p = glm::vec2(n) / (std::abs(n.x) + std::abs(n.y) + std::abs(n.z));
  if (n.z >= 0) return p;
  return {(1 - std::abs(p.y)) * (p.x >= 0 ? 1.0f : -1.0f), (1 - std::abs(p.x)) * (p.y >= 0 ? 1.0f : -1.0f)};
}

/// Unit length.
inline glm::vec3 from_octahedral(const glm::vec2& p) {
  glm::vec3 n(p, 1 - std::abs(p.x) - std::abs(p.y));
  if (n.z < 0) {
    n.x = (1 - std::abs(p.y)) * (p.x >= 0 ? 1.0f : -1.0f);
    n.y = (1 - std::abs(p.x)) * (p.y >= 0 ? 1.0f : -1.0f);
  }
  return glm::normalize(n);
}

/// -1..1 to a signed integer of `bits` bits, of which only the `kept` highest are used: fewer compress better.
inline uint32_t snorm(float value, int bits, int kept) {
  const auto most = static_cast<int32_t>((1u << (bits - 1)) - 1);
  const int32_t step = 1 << (bits - kept);
  const auto rounded = static_cast<int32_t>(std::lround(value * static_cast<float>(most) / static_cast<float>(step)));
  return static_cast<uint32_t>(std::clamp(rounded * step, -most, most)) & ((1u << bits) - 1);
}

inline float from_snorm(uint32_t value, int bits) {
  const auto extended = static_cast<int32_t>(value << (32 - bits)) >> (32 - bits);
  return std::max(static_cast<float>(extended) / static_cast<float>((1u << (bits - 1)) - 1), -1.0f);
}

/// VertexAttributes::normal_ls; `kept` bits a side, at most 16.
inline uint32_t encode_normal(const glm::vec3& normal, int kept = 16) {
  const glm::vec2 p = octahedral(normal);
  return snorm(p.x, 16, kept) | snorm(p.y, 16, kept) << 16;
}

inline glm::vec3 decode_normal(uint32_t bits) {
  return from_octahedral({from_snorm(bits & 0xFFFFu, 16), from_snorm(bits >> 16, 16)});
}

/// VertexAttributes::tangent_ls: w is the bitangent's sign; `kept` bits a side, at most 15.
inline uint32_t encode_tangent(const glm::vec4& tangent, int kept = 15) {
  const glm::vec2 p = octahedral(tangent);
  return snorm(p.x, 16, kept) | snorm(p.y, 15, kept) << 16 | (tangent.w < 0 ? 0x80000000u : 0u);
}

inline glm::vec4 decode_tangent(uint32_t bits) {
  return {from_octahedral({from_snorm(bits & 0xFFFFu, 16), from_snorm(bits >> 16 & 0x7FFFu, 15)}),
          (bits >> 31) != 0 ? -1.0f : 1.0f};
}

}  // namespace chandelier::pack
