// SPDX-License-Identifier: Apache-2.0
// Decoding and mip levels.
#include <OpenImageIO/imageio.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "bake/images.h"
#include "gltf_builder.h"

namespace chandelier::baker::test {
namespace {

using Bytes = std::vector<std::uint8_t>;

/// Texels of one grey each, opaque.
Texels grey(std::uint32_t width, std::uint32_t height, const Bytes& values) {
  Texels out{width, height, Bytes(4 * values.size(), 255)};
  for (std::size_t i = 0; i < values.size(); ++i) std::fill_n(out.rgba.begin() + 4 * i, 3, values[i]);
  return out;
}

Bytes channel(const Bytes& rgba, std::size_t c) {
  Bytes out;
  for (std::size_t i = c; i < rgba.size(); i += 4) out.push_back(rgba[i]);
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
    const auto v = static_cast<std::uint8_t>(value);
    EXPECT_EQ(channel(mip_chain(grey(2, 2, {v, v, v, v}), ImageUse::color), 0), (Bytes{v, v, v, v, v}));
  }
}

TEST(Mips, GoDownToOneTexelHalvingEachSideRoundedDown) {
  EXPECT_EQ(mip_level_count(1, 1), 1u);
  EXPECT_EQ(mip_level_count(16384, 1), 15u);
  EXPECT_EQ(mip_level_count(5, 3), 3u);
  // 5x3, 2x1, 1x1
  EXPECT_EQ(mip_chain(grey(5, 3, Bytes(15, 7)), ImageUse::data).size(), 4u * (15 + 2 + 1));
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
  const Texels two{2, 1, {255, 128, 128, 255, 128, 255, 128, 255}};
  const Bytes chain = mip_chain(Texels(two), ImageUse::normal);
  EXPECT_NEAR(chain[8], 218, 1);
  EXPECT_NEAR(chain[9], 218, 1);
  EXPECT_NEAR(chain[10], 128, 1);
}

EncodedImage encoded(const char* extension, int width, int height, int channels, const Bytes& pixels) {
  const std::filesystem::path path = scratch_folder() / (std::string("image.") + extension);
  const auto output = OIIO::ImageOutput::create(path.string());
  OIIO::ImageSpec spec(width, height, channels, OIIO::TypeDesc::UINT8);
  spec.attribute("oiio:UnassociatedAlpha", 1);
  EXPECT_TRUE(output && output->open(path.string(), spec));
  EXPECT_TRUE(output->write_image(OIIO::TypeDesc::UINT8, pixels.data()));
  output->close();
  Bytes bytes(std::filesystem::file_size(path));
  FILE* file = std::fopen(path.c_str(), "rb");
  EXPECT_EQ(std::fread(bytes.data(), 1, bytes.size(), file), bytes.size());
  std::fclose(file);
  return {"image", "test: image", bytes};
}

TEST(Decode, ExpandsEachNumberOfChannelsToRgba) {
  EXPECT_EQ(decode_image(encoded("png", 2, 1, 1, {10, 20})).rgba, (Bytes{10, 10, 10, 255, 20, 20, 20, 255}));
  EXPECT_EQ(decode_image(encoded("png", 1, 1, 2, {10, 20})).rgba, (Bytes{10, 10, 10, 20}));
  EXPECT_EQ(decode_image(encoded("png", 1, 1, 3, {1, 2, 3})).rgba, (Bytes{1, 2, 3, 255}));
  EXPECT_EQ(decode_image(encoded("png", 1, 1, 4, {200, 100, 50, 25})).rgba, (Bytes{200, 100, 50, 25}));
}

TEST(Decode, ReadsJpegWithRowsFromTheTop) {
  Bytes pixels(16 * 16 * 3, 0);
  std::fill(pixels.begin(), pixels.begin() + 8 * 16 * 3, 255);  // the upper half white
  const Texels texels = decode_image(encoded("jpg", 16, 16, 3, pixels));
  EXPECT_EQ(texels.width, 16u);
  EXPECT_EQ(texels.height, 16u);
  EXPECT_GT(texels.rgba.front(), 240);
  EXPECT_LT(texels.rgba[texels.rgba.size() - 4], 15);
}

/// Bytes that do not compress.
Bytes noise(std::size_t count) {
  Bytes out;
  for (std::uint32_t x = 1; out.size() < count; x = x * 1664525u + 1013904223u)
    out.push_back(static_cast<std::uint8_t>(x >> 24));
  return out;
}

std::string decode_error(const EncodedImage& image) {
  try {
    decode_image(image);
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

TEST(Decode, RefusesWhatItCannotDecode) {
  EXPECT_EQ(decode_error({"", "test: image", {1, 2, 3, 4, 5}}), "test: image: is neither PNG nor JPEG (5 bytes)");
  EXPECT_EQ(decode_error({"", "test: image", {0xAB, 'K', 'T', 'X', ' ', '2', '0', 0xBB}}),
            "test: image: is neither PNG nor JPEG but KTX2 (8 bytes)");
  EXPECT_EQ(decode_error({"", "test: image", {}}), "test: image: is neither PNG nor JPEG (0 bytes)");
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
  cut_jpeg = whole_jpeg;
  cut_jpeg.bytes.resize(whole_jpeg.bytes.size() / 2);
  const std::string size = std::to_string(cut_jpeg.bytes.size());
  EXPECT_EQ(decode_error(cut_jpeg), "test: image: JPEG is cut short (" + size + " bytes)");
  EncodedImage short_scan = cut_jpeg;  // ends as a JPEG does, but has half of its blocks
  short_scan.bytes.insert(short_scan.bytes.end(), {0xFF, 0xD9});
  EXPECT_EQ(decode_error(short_scan).rfind("test: image: cannot be decoded: ", 0), 0u) << decode_error(short_scan);
  const EncodedImage wide = encoded("png", 16385, 1, 1, Bytes(16385, 0));
  EXPECT_EQ(decode_error(wide), "test: image: size is out of range, 1 to 16384 (16385x1)");
}

}  // namespace
}  // namespace chandelier::baker::test
