// SPDX-License-Identifier: Apache-2.0
// EXT_mesh_gpu_instancing: one node with many transforms.
#pragma once

#include <cstddef>
#include <glm/glm.hpp>
#include <optional>

#include "gltf.h"

namespace chandelier::baker {

/// The transforms of the instances of the node's mesh, in the node's space; nothing for a node without the extension.
/// Throws Error.
std::optional<std::vector<glm::dmat4>> read_instances(const Gltf& gltf, size_t node);

}  // namespace chandelier::baker
