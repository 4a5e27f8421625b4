// SPDX-License-Identifier: Apache-2.0
// Mip levels by box filter; odd sizes weigh three texels, so that nothing shifts or is left out.
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

#include "images.h"

namespace chandelier::baker {
namespace {

double linear_of(double srgb) {
  return srgb <= 0.04045 ? srgb / 12.92 : std::pow((srgb + 0.055) / 1.055, 2.4);
}

/// The sRGB curve for 8-bit values, both ways, rounded exactly.
struct SrgbTable {
  std::array<float, 256> linear;     // of each code
  std::array<float, 257> threshold;  // the code is the number of thresholds 1..255 not above the value
  std::array<std::uint8_t, 4097> guess;

  SrgbTable() {
    for (int i = 0; i < 256; ++i) linear[i] = static_cast<float>(linear_of(i / 255.0));
    for (int i = 0; i < 256; ++i) threshold[i] = static_cast<float>(linear_of((i - 0.5) / 255.0));
    threshold[256] = INFINITY;
    int code = 0;
    for (int i = 0; i <= 4096; ++i) {
      while (threshold[code + 1] <= static_cast<float>(i) / 4096.0f) ++code;
      guess[i] = static_cast<std::uint8_t>(code);
    }
  }

  std::uint8_t code(float value) const {
    const float clamped = std::clamp(value, 0.0f, 1.0f);
    int out = guess[static_cast<std::size_t>(clamped * 4096.0f)];
    while (threshold[out + 1] <= clamped) ++out;
    return static_cast<std::uint8_t>(out);
  }
};

const SrgbTable& srgb() {
  static const SrgbTable table;
  return table;
}

struct Level {
  std::uint32_t width, height;
  std::vector<glm::vec4> texels;
};

struct Taps {
  int count;
  std::uint32_t at[3];
  float weight[3];
};

/// The texels of a row of `size` under texel `x` of the row half as long. NVIDIA, "Non-power-of-two mipmap creation".
Taps taps(std::uint32_t size, std::uint32_t x) {
  if (size == 1) return {1, {0}, {1}};
  if (size % 2 == 0) return {2, {2 * x, 2 * x + 1}, {0.5f, 0.5f}};
  const auto whole = static_cast<float>(size), half = static_cast<float>(size / 2), fx = static_cast<float>(x);
  return {3, {2 * x, 2 * x + 1, 2 * x + 2}, {(half - fx) / whole, half / whole, (fx + 1) / whole}};
}

/// `texel(x, y)` of a level of `width` by `height`.
template <typename Texel>
Level halve(std::uint32_t width, std::uint32_t height, Texel texel) {
  Level to{std::max(1u, width / 2), std::max(1u, height / 2), {}};
  to.texels.resize(std::size_t{to.width} * to.height);
  for (std::uint32_t y = 0; y < to.height; ++y) {
    const Taps rows = taps(height, y);
    for (std::uint32_t x = 0; x < to.width; ++x) {
      const Taps columns = taps(width, x);
      glm::vec4 sum(0);
      for (int r = 0; r < rows.count; ++r) {
        for (int c = 0; c < columns.count; ++c) {
          sum += texel(columns.at[c], rows.at[r]) * (rows.weight[r] * columns.weight[c]);
        }
      }
      to.texels[std::size_t{y} * to.width + x] = sum;
    }
  }
  return to;
}

/// Level 1 from the bytes of level 0: floats of level 0 would take four times its memory.
Level halve_bytes(std::uint32_t width, std::uint32_t height, const std::uint8_t* rgba, ImageUse use) {
  std::array<float, 256> plain;
  for (int i = 0; i < 256; ++i) plain[i] = static_cast<float>(i) / 255.0f;
  const std::array<float, 256>& curve = use == ImageUse::color ? srgb().linear : plain;
  return halve(width, height, [&](std::uint32_t x, std::uint32_t y) {
    const std::uint8_t* in = rgba + 4 * (std::size_t{y} * width + x);
    return glm::vec4(curve[in[0]], curve[in[1]], curve[in[2]], plain[in[3]]);
  });
}

glm::vec4 unit_normal(const glm::vec4& texel) {
  const glm::vec3 normal = glm::vec3(texel) * 2.0f - 1.0f;
  const float length = glm::length(normal);
  if (!(length > 1e-6f)) return {0.5f, 0.5f, 1.0f, texel.a};
  return glm::vec4(normal / length * 0.5f + 0.5f, texel.a);
}

void append(const Level& level, ImageUse use, std::vector<std::uint8_t>& out) {
  for (const glm::vec4& stored : level.texels) {
    const glm::vec4 texel = use == ImageUse::normal ? unit_normal(stored) : stored;
    for (int c = 0; c < 4; ++c) {
      const bool curved = use == ImageUse::color && c < 3;
      out.push_back(curved ? srgb().code(texel[c])
                           : static_cast<std::uint8_t>(std::clamp(texel[c], 0.0f, 1.0f) * 255.0f + 0.5f));
    }
  }
}

}  // namespace

std::uint32_t mip_level_count(std::uint32_t width, std::uint32_t height) {
  return static_cast<std::uint32_t>(std::bit_width(std::max(width, height)));
}

std::vector<std::uint8_t> mip_chain(Texels&& top, ImageUse use) {
  std::vector<std::uint8_t> out = std::move(top.rgba);
  const std::uint32_t levels = mip_level_count(top.width, top.height);
  if (levels == 1) return out;
  Level level = halve_bytes(top.width, top.height, out.data(), use);
  out.reserve(out.size() * 3 / 2);
  append(level, use, out);
  for (std::uint32_t i = 2; i < levels; ++i) {
    level = halve(level.width, level.height,
                  [&](std::uint32_t x, std::uint32_t y) { return level.texels[std::size_t{y} * level.width + x]; });
    append(level, use, out);
  }
  return out;
}

}  // namespace chandelier::baker
