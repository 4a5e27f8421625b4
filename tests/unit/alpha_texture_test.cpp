// SPDX-License-Identifier: Apache-2.0
// What an alpha test reads on the CPU: formats, wraps, filters.
#include "truth/alpha_texture.h"

#include <gtest/gtest.h>

#include <array>

namespace chandelier::truth {
namespace {

// A texture over an image whose bytes follow something else.
AlphaTexture texture_of(pack::Image image, std::vector<uint8_t> bytes, const pack::Texture& texture) {
  pack::Contents contents;
  contents.image_data.resize(16, std::byte{77});
  for (const uint8_t byte : bytes) contents.image_data.push_back(std::byte{byte});
  image.first_byte = 16;
  image.size_bytes = image.stored_bytes = bytes.size();
  contents.images = {{}, image};
  return AlphaTexture(pack::view_of(contents), texture);
}

pack::Texture texture_with(pack::Wrap u, pack::Wrap v, pack::Filter filter) {
  pack::Texture texture;
  texture.image = 1;
  texture.wrap_u = u;
  texture.wrap_v = v;
  texture.mag_filter = filter;
  texture.min_filter = filter == pack::Filter::linear ? pack::Filter::nearest : pack::Filter::linear;
  return texture;
}

constexpr auto repeat = pack::Wrap::repeat;
constexpr auto clamp = pack::Wrap::clamp_to_edge;
constexpr auto mirror = pack::Wrap::mirrored_repeat;

// Two rows of three texels, alpha 0, 51, 102 and 153, 204, 255, then a level of one texel that nothing may read.
AlphaTexture six_texels(pack::Wrap u, pack::Wrap v, pack::Filter filter) {
  std::vector<uint8_t> bytes(4 * 7, 9);
  for (size_t i = 0; i < 6; ++i) bytes[4 * i + 3] = static_cast<uint8_t>(51 * i);
  return texture_of({.width = 3, .height = 2, .level_count = 2, .format = pack::ImageFormat::rgba8_srgb}, bytes,
                    texture_with(u, v, filter));
}

TEST(AlphaTexture, NearestTexelsOfTheLargestLevelFromTheTop) {
  const AlphaTexture texture = six_texels(clamp, clamp, pack::Filter::nearest);
  for (int i = 0; i < 6; ++i) {
    const glm::vec2 corner(static_cast<float>(i % 3) / 3.0f, static_cast<float>(i / 3) / 2.0f);
    const float expected = 0.2f * static_cast<float>(i);
    EXPECT_NEAR(texture.at(corner + glm::vec2(0.01f)), expected, 1e-6f) << i;
    EXPECT_NEAR(texture.at(corner + glm::vec2(0.32f, 0.49f)), expected, 1e-6f) << i;
  }
}

// Along u, in the upper row (0, 0.2, 0.4), from the fourth texel before the image to the sixth after it.
TEST(AlphaTexture, WrapsAsVulkanDoes) {
  struct Case {
    pack::Wrap wrap;
    std::array<float, 13> texels;
  };
  const Case cases[]{{repeat, {2, 0, 1, 2, 0, 1, 2, 0, 1, 2, 0, 1, 2}},
                     {clamp, {0, 0, 0, 0, 0, 1, 2, 2, 2, 2, 2, 2, 2}},
                     {mirror, {2, 2, 1, 0, 0, 1, 2, 2, 1, 0, 0, 1, 2}}};
  for (const Case& c : cases) {
    const AlphaTexture along_u = six_texels(c.wrap, clamp, pack::Filter::nearest);
    for (int i = 0; i < 13; ++i)
      EXPECT_NEAR(along_u.at({(static_cast<float>(i) - 3.5f) / 3.0f, 0.1f}), 0.2f * c.texels[static_cast<size_t>(i)],
                  1e-6f)
          << static_cast<int>(c.wrap) << ", texel " << i - 4;
  }
  const AlphaTexture along_v = six_texels(clamp, mirror, pack::Filter::nearest);
  const float rows[]{0.6f, 0.0f, 0.0f, 0.6f, 0.6f, 0.0f, 0.0f};
  for (int i = 0; i < 7; ++i)
    EXPECT_NEAR(along_v.at({0.0f, (static_cast<float>(i) - 1.5f) / 2.0f}), rows[i], 1e-6f) << i;
}

TEST(AlphaTexture, FarCoordinatesStayInTheImage) {
  for (const pack::Wrap wrap : {repeat, clamp, mirror})
    for (const float far : {1e9f, -1e9f, 3e38f, -3e38f}) {
      const float alpha = six_texels(wrap, wrap, pack::Filter::linear).at({far, far});
      EXPECT_GE(alpha, 0.0f);
      EXPECT_LE(alpha, 1.0f);
    }
}

TEST(AlphaTexture, LinearBetweenTexelsAndAcrossTheSeam) {
  const AlphaTexture clamped = six_texels(clamp, clamp, pack::Filter::linear);
  EXPECT_NEAR(clamped.at({0.5f / 3.0f, 0.25f}), 0.0f, 1e-6f);
  EXPECT_NEAR(clamped.at({1.0f / 3.0f, 0.25f}), 0.1f, 1e-6f);
  EXPECT_NEAR(clamped.at({1.0f / 3.0f, 0.5f}), 0.4f, 1e-6f);
  EXPECT_NEAR(clamped.at({0.0f, 0.0f}), 0.0f, 1e-6f);
  EXPECT_NEAR(six_texels(repeat, clamp, pack::Filter::linear).at({0.0f, 0.25f}), 0.2f, 1e-6f);
  EXPECT_NEAR(six_texels(mirror, clamp, pack::Filter::linear).at({0.0f, 0.25f}), 0.0f, 1e-6f);
}

// Khronos Data Format Specification, BC3: with a0 > a1 six values between, else four of them, 0 and 255.
TEST(AlphaTexture, DecodesBc3) {
  // Texel i of a block takes value i % 8: sixteen numbers of three bits, lowest first.
  const auto block = [](uint8_t first, uint8_t second) {
    std::vector<uint8_t> bytes{first, second};
    uint64_t numbers = 0;
    for (uint64_t i = 0; i < 16; ++i) numbers |= i % 8 << 3 * i;
    for (int i = 0; i < 6; ++i) bytes.push_back(static_cast<uint8_t>(numbers >> 8 * i));
    bytes.resize(16, 0xAA);  // colours
    return bytes;
  };
  std::vector<uint8_t> bytes = block(210, 70);
  const std::vector<uint8_t> right = block(50, 250);
  bytes.insert(bytes.end(), right.begin(), right.end());
  const AlphaTexture texture =
      texture_of({.width = 7, .height = 3, .level_count = 1, .format = pack::ImageFormat::bc3_srgb}, bytes,
                 texture_with(clamp, clamp, pack::Filter::nearest));
  const std::array<float, 8> left_values{210, 70, 190, 170, 150, 130, 110, 90};
  const std::array<float, 8> right_values{50, 250, 90, 130, 170, 210, 0, 255};
  for (size_t y = 0; y < 3; ++y)
    for (size_t x = 0; x < 7; ++x) {
      const float expected = (x < 4 ? left_values : right_values)[(4 * y + x % 4) % 8] / 255.0f;
      EXPECT_NEAR(texture.at({(static_cast<float>(x) + 0.5f) / 7.0f, (static_cast<float>(y) + 0.5f) / 3.0f}), expected,
                  1e-6f)
          << x << ", " << y;
    }
}

TEST(AlphaTexture, ReadsHalfFloats) {
  const std::array<uint8_t, 16> bytes{1, 2, 3, 4, 5, 6, 0x00, 0x34, 1, 2, 3, 4, 5, 6, 0x00, 0x3A};  // alpha 1/4, 3/4
  const pack::Image image{.width = 2, .height = 1, .level_count = 1, .format = pack::ImageFormat::rgba16_sfloat};
  const AlphaTexture texture =
      texture_of(image, {bytes.begin(), bytes.end()}, texture_with(clamp, clamp, pack::Filter::linear));
  EXPECT_EQ(texture.at({0.25f, 0.5f}), 0.25f);
  EXPECT_EQ(texture.at({0.5f, 0.5f}), 0.5f);
  EXPECT_EQ(texture.at({0.75f, 0.5f}), 0.75f);
}

TEST(AlphaTexture, RefusesAnUnknownFormat) {
  pack::Image image{.width = 1, .height = 1, .level_count = 1, .format = pack::ImageFormat{7}};
  EXPECT_THROW(texture_of(image, std::vector<uint8_t>(16), texture_with(clamp, clamp, pack::Filter::linear)),
               std::invalid_argument);
}

TEST(AlphaTexture, FormatsWithoutAlphaAreOpaque) {
  for (const auto format : {pack::ImageFormat::bc1_srgb, pack::ImageFormat::bc1_unorm, pack::ImageFormat::bc5_unorm})
    EXPECT_EQ(texture_of({.width = 4, .height = 4, .level_count = 1, .format = format}, std::vector<uint8_t>(16, 0),
                         texture_with(repeat, repeat, pack::Filter::linear))
                  .at({0.3f, 0.7f}),
              1.0f);
}

}  // namespace
}  // namespace chandelier::truth
