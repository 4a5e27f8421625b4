// SPDX-License-Identifier: Apache-2.0
#include "lights/mean_materials.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/gtc/packing.hpp>

#include "image_format.h"
#include "pack_images.h"

namespace chandelier {
namespace {

// IEC 61966-2-1
float linear_from_srgb(float x) {
  return x <= 0.04045f ? x / 12.92f : std::pow((x + 0.055f) / 1.055f, 2.4f);
}

float half_at(const uint8_t* bytes) {
  return glm::unpackHalf1x16(static_cast<uint16_t>(bytes[0] | bytes[1] << 8));
}

glm::vec3 from_565(uint32_t bits) {
  return glm::vec3(bits >> 11 & 31u, bits >> 5 & 63u, bits & 31u) / glm::vec3(31, 63, 31);
}

// The colour half of a BC1 or BC3 block (Khronos Data Format Specification 1.3, §20).
glm::vec3 block_texel(const uint8_t* block, uint32_t texel, bool four_colors) {
  const uint32_t c0 = block[0] | block[1] << 8u;
  const uint32_t c1 = block[2] | block[3] << 8u;
  const uint32_t choice = block[4 + texel / 4] >> 2 * (texel % 4) & 3u;
  const glm::vec3 a = from_565(c0), b = from_565(c1);
  if (choice < 2) return choice == 0 ? a : b;
  if (four_colors || c0 > c1) return choice == 2 ? (2.0f * a + b) / 3.0f : (a + 2.0f * b) / 3.0f;
  return choice == 2 ? (a + b) / 2.0f : glm::vec3(0.0f);
}

// One channel of a BC5 block: two ends, and eight or six values from one to the other.
float channel_texel(const uint8_t* block, uint32_t texel) {
  uint64_t choices = 0;
  for (uint32_t i = 0; i < 6; ++i) choices |= uint64_t{block[2 + i]} << 8 * i;
  const auto choice = static_cast<uint32_t>(choices >> 3 * texel & 7u);
  const float a = static_cast<float>(block[0]) / 255.0f, b = static_cast<float>(block[1]) / 255.0f;
  if (choice < 2) return choice == 0 ? a : b;
  const uint32_t steps = block[0] > block[1] ? 7 : 5;
  if (choice > steps) return choice == 6 ? 0.0f : 1.0f;
  return glm::mix(a, b, static_cast<float>(choice - 1) / static_cast<float>(steps));
}

// The colour of a texel as it is stored; `i`: of the level's texels, row by row.
glm::vec3 stored_texel(pack::ImageFormat format, const pack::ImageLevel& level, const uint8_t* bytes, uint32_t i) {
  const pack::TexelBlock block = pack::block_of(format);
  const uint32_t x = i % level.width, y = i / level.width;
  const uint8_t* const at =
      bytes + size_t{block.bytes} * (y / block.side_texels * level.blocks_wide + x / block.side_texels);
  switch (format) {
    case pack::ImageFormat::rgba8_srgb:
    case pack::ImageFormat::rgba8_unorm:
      return glm::vec3(at[0], at[1], at[2]) / 255.0f;
    case pack::ImageFormat::rgba16_sfloat:
      return {half_at(at), half_at(at + 2), half_at(at + 4)};
    case pack::ImageFormat::bc1_srgb:
    case pack::ImageFormat::bc1_unorm:
      return block_texel(at, 4 * (y % 4) + x % 4, false);
    case pack::ImageFormat::bc3_srgb:
      return block_texel(at + 8, 4 * (y % 4) + x % 4, true);
    case pack::ImageFormat::bc5_unorm:
      return {channel_texel(at, 4 * (y % 4) + x % 4), channel_texel(at + 8, 4 * (y % 4) + x % 4), 0.0f};
  }
  pack::refuse_format(format);
}

// Linear colour of the smallest level.
glm::vec3 mean_texel(const pack::View& pack, uint32_t number) {
  const pack::Image& image = pack.images[number];
  const pack::Texels texels = pack::texels_of(pack, number);
  const pack::ImageLevel level = pack::level_of(image, image.level_count - 1);
  const auto* bytes = reinterpret_cast<const uint8_t*>(texels.bytes().last(level.bytes).data());
  glm::vec3 sum(0.0f);
  for (uint32_t i = 0; i < level.width * level.height; ++i) {
    glm::vec3 texel = stored_texel(image.format, level, bytes, i);
    if (pack::is_srgb(image.format))
      texel = {linear_from_srgb(texel.x), linear_from_srgb(texel.y), linear_from_srgb(texel.z)};
    sum += texel;
  }
  return sum / static_cast<float>(level.width * level.height);
}

// By the number of the image; of those that no colour is read from nothing.
std::vector<glm::vec3> mean_texels(const pack::View& pack) {
  std::vector<uint8_t> is_needed(pack.images.size(), 0);
  for (const pack::Material& m : pack.materials)
    for (const uint32_t texture : {m.base_color_texture, m.metallic_roughness_texture, m.emissive_texture})
      if (texture != pack::none) is_needed[pack.textures[texture].image] = 1;
  std::vector<glm::vec3> means(pack.images.size());
  for (uint32_t i = 0; i < means.size(); ++i)
    if (is_needed[i]) means[i] = mean_texel(pack, i);  // one at a time in memory; each is decoded in threads
  return means;
}

}  // namespace

std::vector<MeanMaterial> mean_materials(const pack::View& pack) {
  const std::vector<glm::vec3> of_image = mean_texels(pack);
  const auto mean = [&](uint32_t texture) {
    return texture == pack::none ? glm::vec3(1.0f) : of_image[pack.textures[texture].image];
  };
  std::vector<MeanMaterial> means;
  for (const pack::Material& m : pack.materials) {
    const glm::vec3 metal_rough = mean(m.metallic_roughness_texture);
    const glm::vec3 base = glm::vec3(m.base_color_factor) * mean(m.base_color_texture);
    means.push_back({.base_color = m.unlit ? base : glm::min(base, 1.0f),  // as shading/g_buffer.glsl has it
                     .emissive = m.emissive * mean(m.emissive_texture),
                     .metallic = m.metallic_factor * metal_rough.b,
                     .roughness = m.roughness_factor * metal_rough.g,
                     .unlit = m.unlit != 0,
                     .double_sided = m.double_sided != 0});
  }
  return means;
}

}  // namespace chandelier
