// SPDX-License-Identifier: Apache-2.0
// Mip levels by box filter; odd sizes weigh three texels, so that nothing shifts or is left out.
#include "mips.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <glm/glm.hpp>

#include "alpha_coverage.h"

namespace chandelier::baker {
namespace {

double linear_of(double srgb) {
  return srgb <= 0.04045 ? srgb / 12.92 : std::pow((srgb + 0.055) / 1.055, 2.4);
}

/// The sRGB curve for 8-bit values, both ways, rounded exactly.
struct SrgbTable {
  std::array<float, 256> linear;     // of each code
  std::array<float, 257> threshold;  // the code is the number of thresholds 1..255 not above the value
  std::array<uint8_t, 4097> guess;

  SrgbTable() {
    for (int i = 0; i < 256; ++i) linear[i] = static_cast<float>(linear_of(i / 255.0));
    for (int i = 0; i < 256; ++i) threshold[i] = static_cast<float>(linear_of((i - 0.5) / 255.0));
    threshold[256] = INFINITY;
    int code = 0;
    for (int i = 0; i <= 4096; ++i) {
      while (threshold[code + 1] <= static_cast<float>(i) / 4096.0f) ++code;
      guess[i] = static_cast<uint8_t>(code);
    }
  }

  uint8_t code(float value) const {
    const float clamped = std::clamp(value, 0.0f, 1.0f);
    int out = guess[static_cast<size_t>(clamped * 4096.0f)];
    while (threshold[out + 1] <= clamped) ++out;
    return static_cast<uint8_t>(out);
  }
};

const SrgbTable& srgb() {
  static const SrgbTable table;
  return table;
}

/// A texel between levels: RGB linear, alpha as stored.
struct Level {
  uint32_t width, height;
  std::vector<glm::vec4> texels;
};

struct Taps {
  int count;
  uint32_t at[3];
  float weight[3];
};

/// The texels of a row of `size` under texel `x` of the row half as long. NVIDIA, "Non-power-of-two mipmap creation".
Taps taps(uint32_t size, uint32_t x) {
  if (size == 1) return {1, {0}, {1}};
  if (size % 2 == 0) return {2, {2 * x, 2 * x + 1}, {0.5f, 0.5f}};
  const auto whole = static_cast<float>(size), half = static_cast<float>(size / 2), fx = static_cast<float>(x);
  return {3, {2 * x, 2 * x + 1, 2 * x + 2}, {(half - fx) / whole, half / whole, (fx + 1) / whole}};
}

/// Runs `work(first, end)` over the rows of an image, in parallel.
template <typename Work>
void over_rows(uint32_t width, uint32_t height, Work work) {
  const uint32_t grain = std::max(1u, 32768u / width);  // rows per task
  tbb::parallel_for(tbb::blocked_range<uint32_t>(0, height, grain),
                    [&](const auto& rows) { work(rows.begin(), rows.end()); });
}

/// The mean of the texels under `columns` and `rows`; weighted by alpha if that is tested, since invisible texels add
/// no colour.
template <typename Texel>
glm::vec4 mean(const Taps& columns, const Taps& rows, bool by_alpha, Texel texel) {
  glm::vec4 sum(0);
  glm::vec3 seen(0);
  for (int r = 0; r < rows.count; ++r) {
    for (int c = 0; c < columns.count; ++c) {
      const glm::vec4 value = texel(columns.at[c], rows.at[r]);
      const float weight = rows.weight[r] * columns.weight[c];
      sum += value * weight;
      if (by_alpha) seen += glm::vec3(value) * (value.a * weight);
    }
  }
  return by_alpha && sum.a > 0 ? glm::vec4(seen / sum.a, sum.a) : sum;
}

/// `texel(x, y)` of a level of `width` by `height`.
template <typename Texel>
Level halve(uint32_t width, uint32_t height, bool by_alpha, Texel texel) {
  Level to{std::max(1u, width / 2), std::max(1u, height / 2), {}};
  to.texels.resize(size_t{to.width} * to.height);
  over_rows(to.width, to.height, [&](uint32_t first, uint32_t end) {
    for (uint32_t y = first; y < end; ++y) {
      const Taps rows = taps(height, y);
      for (uint32_t x = 0; x < to.width; ++x) {
        to.texels[size_t{y} * to.width + x] = mean(taps(width, x), rows, by_alpha, texel);
      }
    }
  });
  return to;
}

bool is_srgb(ImageUse use) {
  return use == ImageUse::color || use == ImageUse::masked_color;
}

/// Level 1 from the bytes of level 0: floats of level 0 would take four times its memory.
Level halve(const Texels& top, ImageUse use) {
  std::array<float, 256> plain;
  for (int i = 0; i < 256; ++i) plain[i] = static_cast<float>(i) / 255.0f;
  const std::array<float, 256>& curve = is_srgb(use) ? srgb().linear : plain;
  return halve(top.width, top.height, use == ImageUse::masked_color, [&](uint32_t x, uint32_t y) {
    const uint8_t* in = top.rgba.data() + 4 * (size_t{y} * top.width + x);
    return glm::vec4(curve[in[0]], curve[in[1]], curve[in[2]], plain[in[3]]);
  });
}

Level halve(const Level& from, ImageUse use) {
  return halve(from.width, from.height, use == ImageUse::masked_color,
               [&](uint32_t x, uint32_t y) { return from.texels[size_t{y} * from.width + x]; });
}

glm::vec4 unit_normal(const glm::vec4& texel) {
  glm::vec3 normal = glm::vec3(texel) * 2.0f - 1.0f;
  normal.z = std::max(normal.z, 0.0f);  // readers take z from x and y
  const float length = glm::length(normal);
  if (!(length > 1e-6f)) return {0.5f, 0.5f, 1.0f, texel.a};
  return glm::vec4(normal / length * 0.5f + 0.5f, texel.a);
}

uint8_t plain_code(float value) {
  return static_cast<uint8_t>(std::clamp(value, 0.0f, 1.0f) * 255.0f + 0.5f);
}

void store(const glm::vec4& stored, ImageUse use, uint8_t* out) {
  const glm::vec4 texel = use == ImageUse::normal ? unit_normal(stored) : stored;
  for (int c = 0; c < 3; ++c) out[c] = is_srgb(use) ? srgb().code(texel[c]) : plain_code(texel[c]);
  out[3] = plain_code(texel.a);
}

Texels stored(const Level& level, ImageUse use) {
  Texels out{level.width, level.height, std::vector<uint8_t>(4 * level.texels.size())};
  over_rows(level.width, level.height, [&](uint32_t first, uint32_t end) {
    for (size_t i = size_t{first} * level.width; i < size_t{end} * level.width; ++i) {
      store(level.texels[i], use, &out.rgba[4 * i]);
    }
  });
  return out;
}

void normalize(Texels& top) {
  for (size_t i = 0; i < top.rgba.size(); i += 4) {
    const glm::vec4 texel(top.rgba[i], top.rgba[i + 1], top.rgba[i + 2], top.rgba[i + 3]);
    store(texel / 255.0f, ImageUse::normal, &top.rgba[i]);
  }
}

/// Gives invisible texels the colour of the next smaller level, which comes from the visible texels around them:
/// filters mix it in at edges.
void fill_unseen(Texels& top, std::vector<Level>& levels) {
  const auto below = [](const Level& level, uint32_t x, uint32_t y) {
    const size_t row = std::min(y / 2, level.height - 1);
    return glm::vec3(level.texels[row * level.width + std::min(x / 2, level.width - 1)]);
  };
  for (size_t i = levels.size(); i-- > 1;) {
    Level& level = levels[i - 1];
    for (uint32_t y = 0; y < level.height; ++y) {
      for (uint32_t x = 0; x < level.width; ++x) {
        glm::vec4& texel = level.texels[size_t{y} * level.width + x];
        if (texel.a == 0) texel = glm::vec4(below(levels[i], x, y), 0);
      }
    }
  }
  for (uint32_t y = 0; y < top.height; ++y) {
    for (uint32_t x = 0; x < top.width; ++x) {
      uint8_t* texel = &top.rgba[4 * (size_t{y} * top.width + x)];
      if (texel[3] == 0) store(glm::vec4(below(levels[0], x, y), 0), ImageUse::masked_color, texel);
    }
  }
}

void keep_coverage(const std::vector<Level>& levels, float cutoff, double coverage, std::vector<Texels>& out) {
  for (size_t i = 0; i < levels.size(); ++i) {
    std::vector<float> alphas;
    alphas.reserve(levels[i].texels.size());
    for (const glm::vec4& texel : levels[i].texels) alphas.push_back(texel.a);
    const std::vector<uint8_t> codes = with_coverage(alphas, cutoff, coverage);
    for (size_t t = 0; t < codes.size(); ++t) out[i + 1].rgba[4 * t + 3] = codes[t];
  }
}

}  // namespace

float linear_of_srgb(uint8_t code) {
  return srgb().linear[code];
}

uint8_t srgb_of_linear(float value) {
  return srgb().code(value);
}

uint32_t mip_level_count(uint32_t width, uint32_t height) {
  return static_cast<uint32_t>(std::bit_width(std::max(width, height)));
}

std::vector<Texels> mip_chain(Texels&& top, ImageUse use, float alpha_cutoff, uint32_t max_size) {
  if (use == ImageUse::normal) normalize(top);
  std::vector<Texels> out;
  out.push_back(std::move(top));
  std::vector<Level> levels;  // from the second on
  const bool masked = use == ImageUse::masked_color;
  for (uint32_t i = 1; i < mip_level_count(out[0].width, out[0].height); ++i) {
    Level next = i == 1 ? halve(out[0], use) : halve(levels.back(), use);
    if (!masked) {
      out.push_back(stored(next, use));
      levels.clear();
    }
    levels.push_back(std::move(next));
  }
  if (masked && !levels.empty()) {
    fill_unseen(out[0], levels);
    for (const Level& level : levels) out.push_back(stored(level, use));
    if (alpha_cutoff > 0) keep_coverage(levels, alpha_cutoff, alpha_coverage(out[0].rgba, alpha_cutoff), out);
  }
  const auto fits = [&](const Texels& level) {
    return max_size == 0 || std::max(level.width, level.height) <= max_size;
  };
  out.erase(out.begin(), std::find_if(out.begin(), out.end(), fits));
  return out;
}

}  // namespace chandelier::baker
