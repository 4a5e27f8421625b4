// SPDX-License-Identifier: Apache-2.0
// glTF 2.0 (.gltf, .glb) to Scene.
#pragma once

#include <filesystem>

#include "../error.h"
#include "../scene.h"

namespace chandelier::baker {

/// Appends what the file's default scene shows to `scene`. Throws Error.
void import_gltf(const std::filesystem::path& path, Scene& scene, Warnings& warnings);

}  // namespace chandelier::baker
