// SPDX-License-Identifier: Apache-2.0
// Reads accessors of any component type, stride and sparseness into plain arrays.
#pragma once

#include "gltf.h"

namespace chandelier::baker {

/// The accessor; its count is not larger than its buffer view has bytes. Throws Error.
const tinygltf::Accessor& checked_accessor(const Gltf& gltf, int accessor, const std::string& where);

/// `count` elements of `components` floats, normalized integers mapped to 0..1 or -1..1. Throws Error where bytes are
/// missing, where the accessor has another number of components, or where a value is not finite.
struct Floats {
  std::size_t count = 0;
  std::size_t components = 0;
  std::vector<float> values;
};
Floats read_floats(const Gltf& gltf, int accessor, std::size_t least_components, std::size_t most_components,
                   const std::string& where);

/// Unsigned integers of a scalar accessor, each below `end`. Throws Error.
std::vector<std::uint32_t> read_indices(const Gltf& gltf, int accessor, std::uint64_t end, const std::string& where);

}  // namespace chandelier::baker
