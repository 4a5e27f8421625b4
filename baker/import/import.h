// SPDX-License-Identifier: Apache-2.0
// glTF 2.0 (.gltf, .glb) to Scene.
#pragma once

#include <cstdint>
#include <filesystem>

#include "../error.h"
#include "../scene.h"

namespace chandelier::baker {

struct ImportSettings {
  std::string scene;  // name or number of the glTF's scene, where it has several; empty: the default scene
};

/// Counts of an import.
struct ImportCounts {
  bool has_scene = false;  // the file has the scene that was asked for
  uint64_t hidden_nodes = 0;
  uint64_t scenes_left_out = 0;
  uint64_t converted_materials = 0;  // from specular-glossiness
};

/// Appends what a scene of the file shows to `scene`. Throws Error.
ImportCounts import_gltf(const std::filesystem::path& path, Scene& scene, Warnings& warnings,
                         const ImportSettings& settings = {});

}  // namespace chandelier::baker
