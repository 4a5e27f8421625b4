// SPDX-License-Identifier: Apache-2.0
// Blocks by libsquish. Its cluster fit costs 40 times its range fit and is 2 dB better, most of it in a few blocks; so
// those that range fit does badly are fitted again: measured on Sponza's colours, 34.1 dB without, 35.1 dB with 6 % of
// the blocks fitted again at 4 times the time, 36.2 dB with all.
#include "block_compress.h"

#include <squish.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>

namespace chandelier::baker {
namespace {

constexpr uint64_t poor = 100;  // mean squared error of an 8-bit value: 28 dB

using Rgba16 = std::array<uint8_t, 64>;  // a block's texels

struct Block {
  Rgba16 texels;
  int mask;  // bit i: texel i is inside the image
};

Block block_at(const Texels& image, uint32_t bx, uint32_t by, bool opaque) {
  Block out{{}, 0};
  for (uint32_t i = 0; i < 16; ++i) {
    const uint32_t x = 4 * bx + i % 4, y = 4 * by + i / 4;
    if (x < image.width && y < image.height) out.mask |= 1 << i;
    const size_t column = std::min(x, image.width - 1), row = std::min(y, image.height - 1);
    std::copy_n(&image.rgba[4 * (row * image.width + column)], 4, &out.texels[4 * i]);
    if (opaque) out.texels[4 * i + 3] = 255;
  }
  return out;
}

struct SquaredError {
  uint64_t sum = 0, values = 0;

  void add(int a, int b) {
    sum += static_cast<uint64_t>((a - b) * (a - b));
    ++values;
  }
};

SquaredError color_error(const Block& block, const Rgba16& decoded, bool alpha) {
  SquaredError error;
  for (size_t i = 0; i < 16; ++i) {
    if (!(block.mask >> i & 1)) continue;
    const uint8_t *a = &block.texels[4 * i], *b = &decoded[4 * i];
    if (alpha) error.add(a[3], b[3]);
    if (a[3] == 0) continue;
    for (int c = 0; c < 3; ++c) error.add(a[c], b[c]);
  }
  return error;
}

SquaredError compress_color(const Block& block, bool alpha, uint8_t* out) {
  const int format = alpha ? squish::kDxt5 | squish::kWeightColourByAlpha : squish::kDxt1;
  Rgba16 decoded;
  const auto fit = [&](int with) {
    squish::CompressMasked(block.texels.data(), block.mask, out, format | with);
    squish::Decompress(decoded.data(), out, format);
    return color_error(block, decoded, alpha);
  };
  const SquaredError error = fit(squish::kColourRangeFit);
  return error.sum > poor * error.values ? fit(squish::kColourClusterFit) : error;
}

/// libsquish writes BC5 but does not read it. Each half of a BC5 block has the form of a BC3 block's alpha.
SquaredError compress_two_channels(const Block& block, uint8_t* out) {
  squish::CompressMasked(block.texels.data(), block.mask, out, squish::kBc5);
  SquaredError error;
  for (size_t channel = 0; channel < 2; ++channel) {
    std::array<uint8_t, 16> as_bc3{};
    std::copy_n(out + 8 * channel, 8, as_bc3.begin());
    Rgba16 decoded;
    squish::Decompress(decoded.data(), as_bc3.data(), squish::kDxt5);
    for (size_t i = 0; i < 16; ++i) {
      if (block.mask >> i & 1) error.add(block.texels[4 * i + channel], decoded[4 * i + 3]);
    }
  }
  return error;
}

}  // namespace

Blocks compress_blocks(const Texels& texels, BlockFormat format) {
  const uint32_t columns = (texels.width + 3) / 4, rows = (texels.height + 3) / 4;
  const size_t block_bytes = format == BlockFormat::bc1 ? 8 : 16;
  Blocks out{std::vector<uint8_t>(block_bytes * columns * rows)};
  std::vector<SquaredError> errors(rows);
  tbb::parallel_for(uint32_t{0}, rows, [&](uint32_t by) {
    for (uint32_t bx = 0; bx < columns; ++bx) {
      const Block block = block_at(texels, bx, by, format == BlockFormat::bc1);
      uint8_t* to = &out.bytes[block_bytes * (size_t{by} * columns + bx)];
      const SquaredError error = format == BlockFormat::bc5 ? compress_two_channels(block, to)
                                                            : compress_color(block, format == BlockFormat::bc3, to);
      errors[by].sum += error.sum;
      errors[by].values += error.values;
    }
  });
  for (const SquaredError& error : errors) {
    out.squared_error += error.sum;
    out.values += error.values;
  }
  return out;
}

}  // namespace chandelier::baker
