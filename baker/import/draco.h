// SPDX-License-Identifier: Apache-2.0
// KHR_draco_mesh_compression: compressed primitives.
#pragma once

#include <cstdint>
#include <map>

#include "accessor.h"

namespace chandelier::baker {

struct DracoPrimitive {
  std::map<std::string, Elements> attributes;  // by glTF's names
  std::vector<uint32_t> indices;               // a triangle list
};

/// The extension's object in a primitive, or nullptr.
const Json* draco_of(const Json& primitive);

/// Decodes what `draco_of` names; its counts must be those of the primitive's accessors. Throws Error.
DracoPrimitive decode_draco(const Gltf& gltf, const Json& primitive, const std::string& where);

}  // namespace chandelier::baker
