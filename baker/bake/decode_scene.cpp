// SPDX-License-Identifier: Apache-2.0
// Decodes the sources of an image of the scene, and converts them.
#include "decode_scene.h"

#include <algorithm>
#include <vector>

#include "convert_specular.h"
#include "decode.h"

namespace chandelier::baker {
namespace {

/// The width and height of an image that is converted from others are the larger ones of theirs.
void refuse_odd_pair(const EncodedImage& image, const std::vector<Texels>& sources) {
  constexpr uint64_t most_growth = 4, free_texels = uint64_t{1} << 24;
  uint64_t width = 0, height = 0, largest = 0;
  for (const Texels& source : sources) {
    width = std::max<uint64_t>(width, source.width);
    height = std::max<uint64_t>(height, source.height);
    largest = std::max(largest, uint64_t{source.width} * source.height);
  }
  if (width * height <= std::max(free_texels, most_growth * largest)) return;
  const auto size = [](const Texels& of) { return std::to_string(of.width) + "x" + std::to_string(of.height); };
  fail(image.where,
       "its shape differs too much from that of its specularGlossinessTexture to make one image of both (" +
           size(sources.front()) + " and " + size(sources.back()) + ")");
}

}  // namespace

uint64_t claimed_texels(const Scene& scene, uint32_t image) {
  uint64_t texels = 0;
  ClaimedSize converted;
  for_each_source(scene, image, [&](uint32_t source) {
    const ClaimedSize size = claimed_size(scene.images[source]);
    texels += size.texels();
    converted = {std::max(converted.width, size.width), std::max(converted.height, size.height)};
  });
  if (!scene.images[image].converted_from) return texels;
  return texels + 2 * converted.texels();  // two images are made of it
}

SceneTexels decode_image(const Scene& scene, uint32_t image) {
  SceneTexels out;
  std::vector<Texels> sources;
  for_each_source(scene, image, [&](uint32_t source) {
    DecodedTexels decoded = decode_image(scene.images[source]);
    out.damage.push_back(std::move(decoded.damage));
    sources.push_back(std::move(decoded.texels));
  });
  const std::optional<SpecularGlossiness>& from = scene.images[image].converted_from;
  if (!from) {
    out.color = std::move(sources[0]);
    return out;
  }
  const Texels* diffuse = from->diffuse == no_index ? nullptr : &sources.front();
  const Texels* glossy = from->specular_glossiness == no_index ? nullptr : &sources.back();
  refuse_odd_pair(scene.images[image], sources);
  MetallicTexels converted = convert_texels(*from, diffuse, glossy);
  out.color = std::move(converted.base_color);
  out.data = std::move(converted.metallic_roughness);
  return out;
}

void report_damage(Scene& scene, uint32_t image, const std::vector<std::string>& damage, bool strict,
                   Warnings& warnings) {
  size_t number = 0;
  for_each_source(scene, image, [&](uint32_t source) {
    const std::string& what = damage.at(number++);
    EncodedImage& encoded = scene.images[source];
    if (what.empty() || encoded.damage_reported) return;
    if (strict) fail(encoded.where, what + ", which --strict refuses");
    encoded.damage_reported = true;
    const bool split = !encoded.file.empty() && encoded.where.size() > encoded.file.size() + 2;
    warnings.add(split ? encoded.file : "scene", "images",
                 what + ": the part that can be decoded is baked; --strict refuses such images",
                 split ? encoded.where.substr(encoded.file.size() + 2) : encoded.where);
  });
}

}  // namespace chandelier::baker
