// SPDX-License-Identifier: Apache-2.0
// Decoding, mip levels and block compression.
#include <gtest/gtest.h>
#include <squish.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>

#include "bake/alpha_coverage.h"
#include "bake/block_compress.h"
#include "bake/decode.h"
#include "encode_image.h"

namespace chandelier::baker::test {
namespace {

using Bytes = std::vector<uint8_t>;

/// Texels of one grey each, opaque.
Texels grey(uint32_t width, uint32_t height, const Bytes& values) {
  Texels out{width, height, Bytes(4 * values.size(), 255)};
  for (size_t i = 0; i < values.size(); ++i) std::fill_n(out.rgba.begin() + 4 * i, 3, values[i]);
  return out;
}

Bytes channel(const Bytes& rgba, size_t c) {
  Bytes out;
  for (size_t i = c; i < rgba.size(); i += 4) out.push_back(rgba[i]);
  return out;
}

/// One channel of all levels, from the largest on.
Bytes channel(const std::vector<Texels>& levels, size_t c) {
  Bytes out;
  for (const Texels& level : levels) {
    const Bytes values = channel(level.rgba, c);
    out.insert(out.end(), values.begin(), values.end());
  }
  return out;
}

/// Red noise with alpha in blotches, the same on every run.
Texels blotches(uint32_t width, uint32_t height) {
  std::mt19937 random(11);
  Texels out{width, height, Bytes(size_t{4} * width * height)};
  for (uint32_t i = 0; i < width * height; ++i) {
    const double x = i % width, y = i / width;
    const double alpha = 100 + 90 * std::sin(x * 0.37) * std::sin(y * 0.23 + 1) + static_cast<double>(random() % 64);
    out.rgba[4 * i] = static_cast<uint8_t>(random());
    out.rgba[4 * i + 3] = static_cast<uint8_t>(std::clamp(alpha, 0.0, 255.0));
  }
  return out;
}

TEST(Mips, AverageColourInLinearLight) {
  // Black and white: half the light is sRGB 0.7354, 187.5 of 255: 188. As data it would be 128.
  EXPECT_EQ(channel(mip_chain(grey(2, 1, {0, 255}), ImageUse::color), 0), (Bytes{0, 255, 188}));
  EXPECT_EQ(channel(mip_chain(grey(2, 1, {0, 255}), ImageUse::data), 0), (Bytes{0, 255, 128}));
}

TEST(Mips, AverageAlphaPlainlyInColour) {
  Texels texels = grey(2, 1, {9, 9});
  texels.rgba[3] = 0;
  EXPECT_EQ(channel(mip_chain(std::move(texels), ImageUse::color), 3), (Bytes{0, 255, 128}));
}

TEST(Mips, KeepEveryColourThatIsTheSameAllOver) {
  for (int value = 0; value < 256; ++value) {
    const auto v = static_cast<uint8_t>(value);
    EXPECT_EQ(channel(mip_chain(grey(2, 2, {v, v, v, v}), ImageUse::color), 0), (Bytes{v, v, v, v, v}));
  }
}

TEST(Mips, GoDownToOneTexelHalvingEachSideRoundedDown) {
  EXPECT_EQ(mip_level_count(1, 1), 1u);
  EXPECT_EQ(mip_level_count(16384, 1), 15u);
  EXPECT_EQ(mip_level_count(5, 3), 3u);
  const std::vector<Texels> levels = mip_chain(grey(5, 3, Bytes(15, 7)), ImageUse::data);
  ASSERT_EQ(levels.size(), 3u);
  EXPECT_EQ(levels[1].width, 2u);
  EXPECT_EQ(levels[1].height, 1u);
  EXPECT_EQ(levels[2].rgba.size(), 4u);
}

TEST(Mips, LeaveOutLevelsAboveTheLimit) {
  const std::vector<Texels> all = mip_chain(grey(5, 3, {0, 9, 3, 7, 5, 1, 8, 2, 6, 4, 0, 9, 3, 7, 5}), ImageUse::data);
  const std::vector<Texels> limited =
      mip_chain(grey(5, 3, {0, 9, 3, 7, 5, 1, 8, 2, 6, 4, 0, 9, 3, 7, 5}), ImageUse::data, 0, 4);
  ASSERT_EQ(limited.size(), 2u);
  EXPECT_EQ(limited[0].width, 2u);
  EXPECT_EQ(limited[0].rgba, all[1].rgba);
  EXPECT_EQ(mip_chain(grey(4, 4, Bytes(16, 1)), ImageUse::data, 0, 4).size(), 3u);
  EXPECT_EQ(mip_chain(grey(4, 4, Bytes(16, 1)), ImageUse::data, 0, 1).size(), 1u);
}

TEST(Mips, WeighAllTexelsOfAnOddSideEqually) {
  // 3 texels into 1: each a third. 0, 30, 90 -> 40.
  EXPECT_EQ(channel(mip_chain(grey(3, 1, {0, 30, 90}), ImageUse::data), 0).back(), 40);
  // 5 texels into 2: 0.4, 0.4, 0.2 and 0.2, 0.4, 0.4: 100 * 0.2 = 20 on both sides.
  const Bytes five = channel(mip_chain(grey(5, 1, {0, 0, 100, 0, 0}), ImageUse::data), 0);
  EXPECT_EQ(five[5], 20);
  EXPECT_EQ(five[6], 20);
}

TEST(Mips, MakeNormalsUnitLengthAgain) {
  // +x and +y: the mean (0.5, 0.5, 0) becomes (0.7071, 0.7071, 0): 0.8536 * 255 = 217.7, and z 127.5 stays in the
  // middle.
  const std::vector<Texels> levels = mip_chain({2, 1, {255, 128, 128, 255, 128, 255, 128, 255}}, ImageUse::normal);
  EXPECT_NEAR(levels[1].rgba[0], 218, 1);
  EXPECT_NEAR(levels[1].rgba[1], 218, 1);
  EXPECT_NEAR(levels[1].rgba[2], 128, 1);
  // The top level too, for its z is not kept: (0.6, 0, 0.6) is (0.7071, 0, 0.7071).
  const std::vector<Texels> top = mip_chain({1, 1, {204, 128, 204, 255}}, ImageUse::normal);
  EXPECT_NEAR(top[0].rgba[0], 218, 1);
  EXPECT_NEAR(top[0].rgba[2], 218, 1);
}

TEST(Mips, GiveWhatIsNotSeenNoColour) {
  // Red that is seen beside green that is not: the mean is red, and green is gone, since filters would mix it in.
  Texels two{2, 1, {200, 0, 0, 255, 0, 200, 0, 0}};
  const std::vector<Texels> levels = mip_chain(std::move(two), ImageUse::masked_color, 0.5f);
  EXPECT_EQ(levels[1].rgba[0], 200);
  EXPECT_EQ(levels[1].rgba[1], 0);
  EXPECT_EQ(levels[0].rgba, (Bytes{200, 0, 0, 255, 200, 0, 0, 0}));
  // By alpha: 255 parts of linear 1 and 85 of 0 are 0.75, sRGB 0.8808: 224.6 of 255.
  const std::vector<Texels> mixed = mip_chain({2, 1, {255, 255, 255, 255, 0, 0, 0, 85}}, ImageUse::masked_color, 0.5f);
  EXPECT_EQ(mixed[1].rgba[0], 225);
}

TEST(Mips, KeepTheCoverageOfAnAlphaTestOnEveryLevel) {
  for (const float cutoff : {0.2f, 0.5f, 0.75f}) {
    const Texels top = blotches(61, 128);
    const double coverage = alpha_coverage(top.rgba, cutoff);
    ASSERT_GT(coverage, 0.02);
    ASSERT_LT(coverage, 0.98);
    for (const Texels& level : mip_chain(Texels(top), ImageUse::masked_color, cutoff)) {
      const double texels = static_cast<double>(level.rgba.size() / 4);
      EXPECT_LE(std::abs(alpha_coverage(level.rgba, cutoff) - coverage) * texels, 1.0) << cutoff << " " << texels;
    }
  }
}

TEST(Mips, WouldLoseCoverageWithoutCare) {
  const Texels top = blotches(64, 64);
  const double coverage = alpha_coverage(top.rgba, 0.75f);
  const std::vector<Texels> plain = mip_chain(Texels(top), ImageUse::color);
  EXPECT_GT(std::abs(alpha_coverage(plain[4].rgba, 0.75f) - coverage) * 16, 1.0);
}

TEST(Coverage, KeepsEqualAlphasEqual) {
  EXPECT_EQ(with_coverage({0.5f, 0.5f, 0.5f, 0.25f}, 0.75f, 0.5),
            (Bytes{192, 192, 192, 96}));  // 3 are nearer to 2 than 0
  EXPECT_EQ(with_coverage({0.9f, 0.9f, 0.9f, 0.9f}, 0.5f, 0.25), (Bytes{127, 127, 127, 127}));
  EXPECT_EQ(with_coverage({0.9f, 0.1f}, 0.5f, 0.5), (Bytes{230, 26}));  // right already: as it is
  EXPECT_EQ(with_coverage({0.2f, 0.0f}, 0.5f, 1.0), (Bytes{128, 128}));
}

/// A block of BC4, as Khronos Data Format 1.3 §20.1 has it.
std::array<int, 16> decode_bc4(const uint8_t* block) {
  const int a = block[0], b = block[1];
  uint64_t bits = 0;
  for (int i = 7; i >= 2; --i) bits = bits << 8 | block[i];
  std::array<int, 16> out{};
  for (int i = 0; i < 16; ++i, bits >>= 3) {
    const int code = static_cast<int>(bits & 7);
    const int steps = a > b ? 7 : 5;
    out[i] = code == 0 ? a : code == 1 ? b : ((steps + 1 - code) * a + (code - 1) * b + steps / 2) / steps;
    if (a <= b && code >= 6) out[i] = code == 6 ? 0 : 255;
  }
  return out;
}

/// RMS error over the channels from `first` to `end` that are inside the image.
double rms_error(const Texels& image, const Bytes& decoded, size_t first, size_t end) {
  double sum = 0;
  for (size_t i = 0; i < image.rgba.size(); ++i) {
    if (i % 4 >= first && i % 4 < end) sum += std::pow(static_cast<double>(image.rgba[i]) - decoded[i], 2);
  }
  return std::sqrt(sum / (static_cast<double>(image.rgba.size() / 4) * static_cast<double>(end - first)));
}

Texels gradient(uint32_t width, uint32_t height) {
  Texels out{width, height, {}};
  for (uint32_t y = 0; y < height; ++y) {
    for (uint32_t x = 0; x < width; ++x) {
      const auto u = static_cast<uint8_t>(255 * x / width), v = static_cast<uint8_t>(255 * y / height);
      out.rgba.insert(out.rgba.end(), {u, u, static_cast<uint8_t>(255 - u), v});
    }
  }
  return out;
}

Bytes decoded(const Texels& image, const Blocks& blocks, int format) {
  Bytes out(image.rgba.size());
  squish::DecompressImage(out.data(), static_cast<int>(image.width), static_cast<int>(image.height),
                          blocks.bytes.data(), format);
  return out;
}

TEST(BlockCompression, StaysNearTheImage) {
  const Texels image = gradient(64, 48);
  const Blocks bc1 = compress_blocks(image, BlockFormat::bc1);
  EXPECT_EQ(bc1.bytes.size(), 8u * 16 * 12);
  EXPECT_LT(rms_error(image, decoded(image, bc1, squish::kDxt1), 0, 3), 3.0);
  const Blocks bc3 = compress_blocks(image, BlockFormat::bc3);
  EXPECT_EQ(bc3.bytes.size(), 16u * 16 * 12);
  EXPECT_LT(rms_error(image, decoded(image, bc3, squish::kDxt5), 3, 4), 1.0);
  const double rms = std::sqrt(static_cast<double>(bc1.squared_error) / static_cast<double>(bc1.values));
  EXPECT_NEAR(rms, rms_error(image, decoded(image, bc1, squish::kDxt1), 0, 3), 1e-9);  // as it says itself
}

TEST(BlockCompression, KeepsTwoChannelsOfANormalMap) {
  const Texels image = gradient(8, 8);
  const Blocks bc5 = compress_blocks(image, BlockFormat::bc5);
  ASSERT_EQ(bc5.bytes.size(), 16u * 4);
  for (size_t block = 0; block < 4; ++block) {
    for (size_t half = 0; half < 2; ++half) {
      const std::array<int, 16> values = decode_bc4(&bc5.bytes[16 * block + 8 * half]);
      for (size_t i = 0; i < 16; ++i) {
        const size_t x = block % 2 * 4 + i % 4, y = block / 2 * 4 + i / 4;
        EXPECT_NEAR(values[i], image.rgba[4 * (y * 8 + x) + half], 8);  // a seventh of the block's range, halved
      }
    }
  }
}

TEST(BlockCompression, FitsBlocksOverTheEdgeToWhatIsInside) {
  for (const auto& [width, height] : {std::pair{1u, 1u}, {2u, 2u}, {3u, 1u}, {5u, 3u}, {1u, 7u}, {9u, 4u}}) {
    Texels image{width, height, Bytes(size_t{4} * width * height)};
    for (size_t i = 0; i < image.rgba.size(); ++i) image.rgba[i] = i % 4 == 3 ? 200 : i % 4 == 0 ? 250 : 20;
    const size_t blocks = size_t{(width + 3) / 4} * ((height + 3) / 4);
    const Blocks bc3 = compress_blocks(image, BlockFormat::bc3);
    ASSERT_EQ(bc3.bytes.size(), 16 * blocks);
    EXPECT_LT(rms_error(image, decoded(image, bc3, squish::kDxt5), 0, 4), 3.0) << width << "x" << height;
    EXPECT_EQ(compress_blocks(image, BlockFormat::bc1).bytes.size(), 8 * blocks);
  }
}

TEST(BlockCompression, IsTheSameOnOneThread) {
  const Texels image = blotches(200, 133);
  const Blocks many = compress_blocks(image, BlockFormat::bc3);
  tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  const Blocks alone = compress_blocks(image, BlockFormat::bc3);
  EXPECT_EQ(alone.bytes, many.bytes);
  EXPECT_EQ(alone.squared_error, many.squared_error);
}

TEST(Decode, ExpandsEachNumberOfChannelsToRgba) {
  EXPECT_EQ(decode_image(encoded("png", 2, 1, 1, {10, 20})).texels.rgba, (Bytes{10, 10, 10, 255, 20, 20, 20, 255}));
  EXPECT_EQ(decode_image(encoded("png", 1, 1, 2, {10, 20})).texels.rgba, (Bytes{10, 10, 10, 20}));
  EXPECT_EQ(decode_image(encoded("png", 1, 1, 3, {1, 2, 3})).texels.rgba, (Bytes{1, 2, 3, 255}));
  EXPECT_EQ(decode_image(encoded("png", 1, 1, 4, {200, 100, 50, 25})).texels.rgba, (Bytes{200, 100, 50, 25}));
}

TEST(Decode, ReadsJpegWithRowsFromTheTop) {
  Bytes pixels(16 * 16 * 3, 0);
  std::fill(pixels.begin(), pixels.begin() + 8 * 16 * 3, 255);  // the upper half white
  const Texels texels = decode_image(encoded("jpg", 16, 16, 3, pixels)).texels;
  EXPECT_EQ(texels.width, 16u);
  EXPECT_EQ(texels.height, 16u);
  EXPECT_GT(texels.rgba.front(), 240);
  EXPECT_LT(texels.rgba[texels.rgba.size() - 4], 15);
}

TEST(Decode, RefusesWhatItCannotDecode) {
  EXPECT_EQ(decode_error({"", "test: image", {1, 2, 3, 4, 5}}), "test: image: is neither PNG, JPEG nor WebP (5 bytes)");
  EXPECT_EQ(decode_error({"", "test: image", {0xAB, 'K', 'T', 'X', ' ', '2', '0', 0xBB}}),
            "test: image: is neither PNG, JPEG nor WebP but KTX2 (8 bytes)");
  EXPECT_EQ(decode_error({"", "test: image", {}}), "test: image: is neither PNG, JPEG nor WebP (0 bytes)");
  EncodedImage cut = encoded("png", 64, 64, 3, Bytes(64 * 64 * 3, 77));
  EncodedImage damaged = cut;
  damaged.bytes[20] ^= 1;  // the width's byte in the header chunk
  EXPECT_EQ(decode_error(damaged), "test: image: PNG is damaged: the checksum of chunk IHDR at byte 8 is wrong");
  cut.bytes.resize(60);
  EXPECT_EQ(decode_error(cut), "test: image: PNG is cut short (60 bytes)");
  cut.bytes.resize(5);
  EXPECT_EQ(decode_error(cut), "test: image: PNG is cut short (5 bytes)");
  EncodedImage cut_jpeg = encoded("jpg", 64, 64, 3, Bytes(64 * 64 * 3, 77));
  cut_jpeg.bytes.resize(40);
  EXPECT_EQ(decode_error(cut_jpeg), "test: image: JPEG is cut short (40 bytes)");
  const EncodedImage whole_jpeg = encoded("jpg", 64, 64, 3, noise(64 * 64 * 3));
  EXPECT_EQ(decode_error(whole_jpeg), "");
  EncodedImage padded = whole_jpeg;
  padded.bytes.insert(padded.bytes.end(), 7, 0);
  EXPECT_EQ(decode_error(padded), "");
  const EncodedImage wide = encoded("png", 16385, 1, 1, Bytes(16385, 0));
  EXPECT_EQ(decode_error(wide), "test: image: size is out of range, 1 to 16384 (16385x1)");
}

}  // namespace
}  // namespace chandelier::baker::test
