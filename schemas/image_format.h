// SPDX-License-Identifier: Apache-2.0
// What each format of an image is: the size of its texels or blocks, and its curve. No format is taken for another.
#pragma once

#include <algorithm>
#include <cstdint>
#include <stdexcept>
#include <string>

#include "pack_schema.h"

namespace chandelier::pack {

[[noreturn]] inline void refuse_format(ImageFormat format) {
  throw std::invalid_argument("no ImageFormat (" + std::to_string(static_cast<uint32_t>(format)) + ")");
}

/// The unit in which texels are stored: a texel, or a block of 4×4.
struct TexelBlock {
  uint32_t side_texels;
  uint32_t bytes;
};

constexpr TexelBlock block_of(ImageFormat format) {
  switch (format) {
    case ImageFormat::rgba8_srgb:
    case ImageFormat::rgba8_unorm:
      return {1, 4};
    case ImageFormat::rgba16_sfloat:
      return {1, 8};
    case ImageFormat::bc1_srgb:
    case ImageFormat::bc1_unorm:
      return {4, 8};
    case ImageFormat::bc3_srgb:
    case ImageFormat::bc5_unorm:
      return {4, 16};
  }
  refuse_format(format);
}

/// Whether sampled colours go through the sRGB curve.
constexpr bool is_srgb(ImageFormat format) {
  switch (format) {
    case ImageFormat::rgba8_srgb:
    case ImageFormat::bc1_srgb:
    case ImageFormat::bc3_srgb:
      return true;
    case ImageFormat::rgba8_unorm:
    case ImageFormat::bc1_unorm:
    case ImageFormat::bc5_unorm:
    case ImageFormat::rgba16_sfloat:
      return false;
  }
  refuse_format(format);
}

/// One mip level of an image whose level_count is above `level`.
struct ImageLevel {
  uint32_t width, height;             // texels
  uint32_t blocks_wide, blocks_high;  // TexelBlocks
  uint64_t bytes;
};

constexpr ImageLevel level_of(const Image& image, uint32_t level) {
  const TexelBlock block = block_of(image.format);
  const uint32_t width = std::max(1u, image.width >> level), height = std::max(1u, image.height >> level);
  const uint32_t wide = (width + block.side_texels - 1) / block.side_texels;
  const uint32_t high = (height + block.side_texels - 1) / block.side_texels;
  return {width, height, wide, high, uint64_t{block.bytes} * wide * high};
}

/// Bytes of all levels of an image with valid fields: `image.size_bytes` must be this.
constexpr uint64_t image_bytes(const Image& image) {
  uint64_t bytes = 0;
  for (uint32_t level = 0; level < image.level_count; ++level) bytes += level_of(image, level).bytes;
  return bytes;
}

/// Whether the bits of a half float are of a number that ImageFormat rgba16_sfloat may hold: neither negative (-0
/// neither) nor infinite nor NaN.
constexpr bool is_half_texel(uint16_t bits) {
  return bits < 0x7C00;
}

}  // namespace chandelier::pack
