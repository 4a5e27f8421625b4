// SPDX-License-Identifier: Apache-2.0
// The alpha of a pack's texture on the CPU, for alpha tests.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "pack_schema.h"

namespace chandelier::truth {

/// Only the largest mip level: a ray has no footprint that would select another one.
class AlphaTexture {
 public:
  /// Copies what it needs.
  AlphaTexture(const pack::View& pack, const pack::Texture& texture);

  /// 0..1, of half floats 0 or more, at the image's coordinates (after the texture's transform), wrapped and magnified
  /// as the texture says; 1 where the format has no alpha.
  float at(const glm::vec2& uv) const;

 private:
  float texel(int64_t x, int64_t y) const;

  int64_t width_;
  int64_t height_;
  pack::Wrap wrap_u_;
  pack::Wrap wrap_v_;
  bool linear_;
  // Rows from the top. One of both is empty; where both are, alpha is 1 everywhere.
  std::vector<uint8_t> alpha_;        // unorm
  std::vector<uint16_t> half_alpha_;  // half floats
};

}  // namespace chandelier::truth
