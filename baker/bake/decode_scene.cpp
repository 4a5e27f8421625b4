// SPDX-License-Identifier: Apache-2.0
// Decodes what an image of the scene is made of, and converts it.
#include "decode_scene.h"

#include <vector>

#include "convert_specular.h"
#include "decode.h"

namespace chandelier::baker {

SceneTexels decode_image(const Scene& scene, std::uint32_t image) {
  SceneTexels out;
  std::vector<Texels> sources;
  for_each_source(scene, image, [&](std::uint32_t source) {
    DecodedTexels decoded = decode_image(scene.images[source]);
    if (!decoded.damage.empty() && out.damage.empty()) out.damage = decoded.damage;
    sources.push_back(std::move(decoded.texels));
  });
  const std::optional<SpecularGlossiness>& from = scene.images[image].converted_from;
  if (!from) {
    out.color = std::move(sources[0]);
    return out;
  }
  const Texels* diffuse = from->diffuse == kNone ? nullptr : &sources.front();
  const Texels* glossy = from->specular_glossiness == kNone ? nullptr : &sources.back();
  MetallicTexels converted = convert_texels(*from, diffuse, glossy);
  out.color = std::move(converted.base_color);
  out.data = std::move(converted.metallic_roughness);
  return out;
}

void tell_damage(const EncodedImage& image, const std::string& damage, bool strict, Warnings& warnings) {
  if (damage.empty()) return;
  if (strict) fail(image.where, damage + ", and --strict was asked for");
  const bool split = !image.file.empty() && image.where.size() > image.file.size() + 2;
  warnings.add(split ? image.file : "scene", split ? image.where.substr(image.file.size() + 2) : image.where,
               damage + ": what could be decoded is baked; --strict refuses it");
}

}  // namespace chandelier::baker
