// SPDX-License-Identifier: Apache-2.0
#include "lights/mean_materials.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace chandelier {
namespace {

// IEC 61966-2-1
float linear_from_srgb(float x) {
  return x <= 0.04045f ? x / 12.92f : std::pow((x + 0.055f) / 1.055f, 2.4f);
}

bool is_srgb(pack::ImageFormat format) {
  return format == pack::ImageFormat::rgba8_srgb || format == pack::ImageFormat::bc1_srgb ||
         format == pack::ImageFormat::bc3_srgb;
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

// Linear colour of the smallest level.
glm::vec3 mean_texel(const pack::View& pack, const pack::Image& image) {
  const uint32_t width = std::max(1u, image.width >> (image.level_count - 1));
  const uint32_t height = std::max(1u, image.height >> (image.level_count - 1));
  const bool raw = image.format == pack::ImageFormat::rgba8_srgb || image.format == pack::ImageFormat::rgba8_unorm;
  const bool bc3 = image.format == pack::ImageFormat::bc3_srgb;
  const uint32_t blocks_wide = (width + 3) / 4;
  const uint32_t block_bytes = bc3 ? 16 : 8;
  const uint64_t level_bytes =
      raw ? uint64_t{4} * width * height : uint64_t{block_bytes} * blocks_wide * ((height + 3) / 4);
  const auto* level =
      reinterpret_cast<const uint8_t*>(pack.image_data.data()) + image.first_byte + image.size_bytes - level_bytes;
  glm::vec3 sum(0.0f);
  for (uint32_t i = 0; i < width * height; ++i) {
    const uint32_t x = i % width, y = i / width;
    const uint8_t* block = level + block_bytes * (y / 4 * blocks_wide + x / 4) + (bc3 ? 8 : 0);
    glm::vec3 texel = raw ? glm::vec3(level[4 * i], level[4 * i + 1], level[4 * i + 2]) / 255.0f
                          : block_texel(block, 4 * (y % 4) + x % 4, bc3);
    if (is_srgb(image.format))
      texel = {linear_from_srgb(texel.x), linear_from_srgb(texel.y), linear_from_srgb(texel.z)};
    sum += texel;
  }
  return sum / static_cast<float>(width * height);
}

}  // namespace

std::vector<MeanMaterial> mean_materials(const pack::View& pack) {
  const auto mean = [&](uint32_t texture) {
    return texture == pack::none ? glm::vec3(1.0f) : mean_texel(pack, pack.images[pack.textures[texture].image]);
  };
  std::vector<MeanMaterial> means;
  for (const pack::Material& m : pack.materials) {
    const glm::vec3 metal_rough = mean(m.metallic_roughness_texture);
    means.push_back({.base_color = glm::vec3(m.base_color_factor) * mean(m.base_color_texture),
                     .emissive = m.emissive * mean(m.emissive_texture),
                     .metallic = m.metallic_factor * metal_rough.b,
                     .roughness = m.roughness_factor * metal_rough.g,
                     .unlit = m.unlit != 0,
                     .double_sided = m.double_sided != 0});
  }
  return means;
}

glm::vec3 reflected(const MeanMaterial& s, const glm::vec3& normal, const glm::vec3& to_eye,
                    const glm::vec3& to_light) {
  const glm::vec3 h = glm::normalize(to_eye + to_light);
  const float n_dot_l = glm::dot(normal, to_light);
  const float n_dot_v = std::max(glm::dot(normal, to_eye), 1e-4f);
  const float n_dot_h = glm::clamp(glm::dot(normal, h), 0.0f, 1.0f);
  const float v_dot_h = glm::clamp(glm::dot(to_eye, h), 0.0f, 1.0f);
  const float a = std::max(s.roughness * s.roughness, 0.002f);
  const float a2 = a * a;
  const float d_root = (n_dot_h * a2 - n_dot_h) * n_dot_h + 1.0f;
  const float d = a2 / (std::numbers::pi_v<float> * d_root * d_root);
  const float smith = n_dot_l * std::sqrt((n_dot_v - n_dot_v * a2) * n_dot_v + a2) +
                      n_dot_v * std::sqrt((n_dot_l - n_dot_l * a2) * n_dot_l + a2);
  const float v = 0.5f / std::max(smith, 1e-6f);
  const glm::vec3 f0 = glm::mix(glm::vec3(0.04f), s.base_color, s.metallic);
  const glm::vec3 f = f0 + (1.0f - f0) * std::pow(1.0f - v_dot_h, 5.0f);
  const glm::vec3 diffuse = s.base_color * ((1.0f - s.metallic) / std::numbers::pi_v<float>);
  return (1.0f - f) * diffuse + f * (d * v);
}

}  // namespace chandelier
