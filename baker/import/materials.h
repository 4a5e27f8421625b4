// SPDX-License-Identifier: Apache-2.0
// glTF materials, textures and images; each is imported when something drawn first uses it.
#pragma once

#include <cstdint>
#include <map>
#include <optional>

#include "../scene.h"
#include "gltf.h"

namespace chandelier::baker {

class Materials {
 public:
  Materials(Gltf& gltf, Scene& scene, Warnings& warnings) : gltf_(gltf), scene_(scene), warnings_(warnings) {}

  /// The scene's material for a glTF material, or for none (-1): glTF's default. Throws Error.
  uint32_t use(int material);

  /// Warns of what was left out of the materials used.
  void warn() const;

  /// Materials of specular-glossiness among those used.
  uint64_t converted() const { return converted_; }

 private:
  uint32_t add_material(int material);
  void read_transmission(const Json& material, const std::string& here, Material& out);
  /// The texture that `owner` names under `key`; `alpha`: its alpha is tested.
  TextureUse use_texture(const Json& owner, const char* key, bool alpha, const std::string& here);
  /// The image of a texture, where it has one that can be read.
  std::optional<uint32_t> image_of(const Json& texture, bool alpha, const std::string& where);
  /// Converts `glossy`, a KHR_materials_pbrSpecularGlossiness, to the nearest metallic-roughness material.
  void convert(const Json& glossy, bool alpha, const std::string& here, Material& out);
  /// Adds the image that the textures of `factors` are converted to, and a texture of it that is otherwise like `like`.
  uint32_t use_converted(const SpecularGlossiness& factors, const TextureUse& like);
  uint32_t use_image(size_t image);
  uint32_t add_texture(size_t texture, uint32_t image);

  Gltf& gltf_;
  Scene& scene_;
  Warnings& warnings_;
  std::map<int, uint32_t> materials_;
  std::map<size_t, uint32_t> textures_, images_;
  std::vector<std::pair<SpecularGlossiness, uint32_t>> converted_images_;
  size_t blended_ = 0, converted_ = 0;
};

}  // namespace chandelier::baker
