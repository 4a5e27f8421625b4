// SPDX-License-Identifier: Apache-2.0
// glTF materials, textures and images: each is taken over when something drawn uses it first.
#pragma once

#include <map>

#include "../scene.h"
#include "gltf.h"

namespace chandelier::baker {

class Materials {
 public:
  Materials(Gltf& gltf, Scene& scene, Warnings& warnings) : gltf_(gltf), scene_(scene), warnings_(warnings) {}

  /// The scene's material for a glTF material, or for none (-1): glTF's default. Throws Error.
  std::uint32_t use(int material);

  /// Says what had to be left out of the materials used.
  void warn() const;

 private:
  std::uint32_t add_material(int material);
  TextureUse use_texture(int texture, int tex_coord, const tinygltf::ExtensionMap& extensions,
                         const std::string& where);
  std::uint32_t use_image(int image);
  std::uint32_t add_texture(int texture);

  Gltf& gltf_;
  Scene& scene_;
  Warnings& warnings_;
  std::map<int, std::uint32_t> materials_, textures_, images_;
  std::size_t blended_ = 0;
};

}  // namespace chandelier::baker
