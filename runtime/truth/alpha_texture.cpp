// SPDX-License-Identifier: Apache-2.0
#include "truth/alpha_texture.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <glm/gtc/packing.hpp>

#include "image_format.h"
#include "pack_images.h"

namespace chandelier::truth {
namespace {

std::vector<uint8_t> alpha_of_rgba8(const pack::Image& image, std::span<const std::byte> texels) {
  std::vector<uint8_t> alpha(size_t{image.width} * image.height);
  for (size_t i = 0; i < alpha.size(); ++i) alpha[i] = std::to_integer<uint8_t>(texels[4 * i + 3]);
  return alpha;
}

// BC3's alpha: two values, and those on the line between them, or fewer of those and 0 and 255.
std::array<uint8_t, 8> bc3_palette(uint8_t first, uint8_t second) {
  std::array<uint8_t, 8> palette{first, second, 0, 0, 0, 0, 0, 255};
  const int steps = first > second ? 7 : 5;
  for (int i = 1; i < steps; ++i)
    palette[static_cast<size_t>(i + 1)] = static_cast<uint8_t>((first * (steps - i) + second * i + steps / 2) / steps);
  return palette;
}

// Blocks of 4×4 texels in 16 bytes: two values, sixteen numbers of three bits, then the colours.
std::vector<uint8_t> alpha_of_bc3(const pack::Image& image, std::span<const std::byte> blocks) {
  std::vector<uint8_t> alpha(size_t{image.width} * image.height);
  const size_t blocks_across = (image.width + 3) / 4;
  for (size_t y = 0; y < image.height; ++y) {
    for (size_t x = 0; x < image.width; ++x) {
      const std::byte* const block = &blocks[16 * (y / 4 * blocks_across + x / 4)];
      const auto byte = [block](size_t i) { return std::to_integer<uint8_t>(block[i]); };
      uint64_t numbers = 0;
      for (size_t i = 0; i < 6; ++i) numbers |= uint64_t{byte(2 + i)} << 8 * i;
      alpha[y * image.width + x] = bc3_palette(byte(0), byte(1))[numbers >> 3 * (y % 4 * 4 + x % 4) & 7];
    }
  }
  return alpha;
}

// Half floats, as bits.
std::vector<uint16_t> alpha_of_halves(const pack::Image& image, std::span<const std::byte> texels) {
  std::vector<uint16_t> alpha(size_t{image.width} * image.height);
  for (size_t i = 0; i < alpha.size(); ++i) std::memcpy(&alpha[i], &texels[8 * i + 6], sizeof(uint16_t));
  return alpha;
}

// Reduced to a few periods around 0..1, so that a texel's number fits its type.
float near_origin(float u, pack::Wrap wrap) {
  if (wrap == pack::Wrap::clamp_to_edge) return std::clamp(u, -1.0f, 2.0f);
  return u - 2.0f * std::floor(0.5f * u);
}

int64_t wrapped(int64_t i, int64_t size, pack::Wrap wrap) {
  if (wrap == pack::Wrap::clamp_to_edge) return std::clamp(i, int64_t{0}, size - 1);
  const int64_t in_two = ((i % (2 * size)) + 2 * size) % (2 * size);
  if (wrap == pack::Wrap::repeat) return in_two % size;
  return in_two < size ? in_two : 2 * size - 1 - in_two;
}

}  // namespace

AlphaTexture::AlphaTexture(const pack::View& pack, const pack::Texture& texture)
    : width_(pack.images[texture.image].width),
      height_(pack.images[texture.image].height),
      wrap_u_(texture.wrap_u),
      wrap_v_(texture.wrap_v),
      linear_(texture.mag_filter == pack::Filter::linear) {
  const pack::Image& image = pack.images[texture.image];
  const pack::Texels texels = pack::texels_of(pack, texture.image);
  const std::span<const std::byte> bytes = texels.bytes();
  switch (image.format) {
    case pack::ImageFormat::rgba8_srgb:
    case pack::ImageFormat::rgba8_unorm:
      alpha_ = alpha_of_rgba8(image, bytes);
      return;
    case pack::ImageFormat::rgba16_sfloat:
      half_alpha_ = alpha_of_halves(image, bytes);
      return;
    case pack::ImageFormat::bc3_srgb:
      alpha_ = alpha_of_bc3(image, bytes);
      return;
    case pack::ImageFormat::bc1_srgb:
    case pack::ImageFormat::bc1_unorm:
    case pack::ImageFormat::bc5_unorm:
      return;  // without alpha
  }
  pack::refuse_format(image.format);
}

float AlphaTexture::texel(int64_t x, int64_t y) const {
  const auto i = static_cast<size_t>(wrapped(y, height_, wrap_v_) * width_ + wrapped(x, width_, wrap_u_));
  return alpha_.empty() ? glm::unpackHalf1x16(half_alpha_[i]) : static_cast<float>(alpha_[i]) / 255.0f;
}

float AlphaTexture::at(const glm::vec2& uv) const {
  if (alpha_.empty() && half_alpha_.empty()) return 1.0f;
  const float x = near_origin(uv.x, wrap_u_) * static_cast<float>(width_);
  const float y = near_origin(uv.y, wrap_v_) * static_cast<float>(height_);
  if (!linear_) return texel(static_cast<int64_t>(std::floor(x)), static_cast<int64_t>(std::floor(y)));
  const float left = std::floor(x - 0.5f), top = std::floor(y - 0.5f);
  const auto i = static_cast<int64_t>(left), j = static_cast<int64_t>(top);
  const float right_part = x - 0.5f - left, low_part = y - 0.5f - top;
  return glm::mix(glm::mix(texel(i, j), texel(i + 1, j), right_part),
                  glm::mix(texel(i, j + 1), texel(i + 1, j + 1), right_part), low_part);
}

}  // namespace chandelier::truth
