// SPDX-License-Identifier: Apache-2.0
// Converts each texel by itself, rows in parallel.
#include "convert_specular.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

#include "../specular_glossiness.h"

namespace chandelier::baker {
namespace {

/// RGB linear, alpha plain.
glm::vec4 texel_at(const Texels& image, uint32_t x, uint32_t y) {
  const uint8_t* rgba = image.rgba.data() + 4 * (size_t{y} * image.width + x);
  return {linear_of_srgb(rgba[0]), linear_of_srgb(rgba[1]), linear_of_srgb(rgba[2]),
          static_cast<float>(rgba[3]) / 255.0f};
}

/// Two neighbours along a side, and the share of the second.
struct Neighbours {
  uint32_t a, b;
  float share;
};

/// The neighbours of the centre of texel `at` of `to`, in a side of `from` texels, clamped to it.
Neighbours neighbours(uint32_t at, uint32_t to, uint32_t from) {
  const double place = (at + 0.5) * from / to - 0.5, below = std::floor(place);
  const auto clamped = [&](double texel) {
    return static_cast<uint32_t>(std::clamp(texel, 0.0, static_cast<double>(from - 1)));
  };
  return {clamped(below), clamped(below + 1), static_cast<float>(place - below)};
}

/// An image, or white, in the size of another.
struct Sampled {
  const Texels* image;
  uint32_t width, height;

  glm::vec4 at(uint32_t x, uint32_t y) const {
    if (!image) return glm::vec4(1);
    if (image->width == width && image->height == height) return texel_at(*image, x, y);
    const Neighbours u = neighbours(x, width, image->width), v = neighbours(y, height, image->height);
    const auto row = [&](uint32_t of) {
      return glm::mix(texel_at(*image, u.a, of), texel_at(*image, u.b, of), u.share);
    };
    return glm::mix(row(v.a), row(v.b), v.share);
  }
};

uint8_t code_of(float value) {
  return static_cast<uint8_t>(std::lround(std::clamp(value, 0.0f, 1.0f) * 255.0f));
}

}  // namespace

MetallicTexels convert_texels(const SpecularGlossiness& factors, const Texels* diffuse, const Texels* glossy) {
  const auto larger = [&](uint32_t Texels::*side) {
    return std::max(diffuse ? diffuse->*side : 1, glossy ? glossy->*side : 1);
  };
  const uint32_t width = larger(&Texels::width), height = larger(&Texels::height);
  const size_t bytes = size_t{4} * width * height;
  MetallicTexels out{{width, height, std::vector<uint8_t>(bytes, 255)},
                     {width, height, std::vector<uint8_t>(bytes, 255)}};
  const Sampled by_diffuse{diffuse, width, height}, by_glossy{glossy, width, height};
  tbb::parallel_for(uint32_t{0}, height, [&](uint32_t y) {
    for (uint32_t x = 0; x < width; ++x) {
      const glm::vec4 color = by_diffuse.at(x, y), mirror = by_glossy.at(x, y);
      const MetallicColor made =
          metallic_color(glm::vec3(color) * factors.diffuse_factor, glm::vec3(mirror) * factors.specular_factor);
      const size_t texel = 4 * (size_t{y} * width + x);
      uint8_t *base = &out.base_color.rgba[texel], *rough = &out.metallic_roughness.rgba[texel];
      for (int c = 0; c < 3; ++c) base[c] = srgb_of_linear(made.base_color[c]);
      base[3] = code_of(color.a);
      rough[1] = code_of(1 - mirror.a * factors.glossiness_factor);
      rough[2] = code_of(made.metallic);
    }
  });
  return out;
}

}  // namespace chandelier::baker
