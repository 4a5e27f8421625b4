// SPDX-License-Identifier: Apache-2.0
// glTF primitives to triangle lists.
#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "../scene.h"
#include "gltf.h"

namespace chandelier::baker {

/// The total size of a file's geometry. A few bytes can ask for much: accessors without data are all zeros, and many
/// primitives can share one.
struct GeometrySize {
  uint64_t bytes = 0;    // of vertices and indices in memory
  uint64_t zeros = 0;    // elements of accessors without data
  uint64_t morphed = 0;  // vertices that morph targets move
};

/// Adds a primitive, shown with these morph weights, to `total` before anything of it is read. Throws Error above
/// 16 GiB, which holds 100 million triangles, above 2^22 zeros or 2^30 morphed vertices.
void add_size(const Gltf& gltf, size_t mesh, size_t primitive, std::span<const double> morph_weights,
              GeometrySize& total);

/// A primitive's triangles, or nothing if it has none (points, lines, no positions); its warnings; its error.
/// Primitives are read in parallel, so messages are kept and printed later in the file's order.
struct ReadPrimitive {
  std::optional<Primitive> primitive;
  std::vector<std::string> warnings;
  std::string error;
};

/// The material is left to the caller. Joints and weights are read where it is `skinned`; morph targets are applied by
/// their weights.
ReadPrimitive read_primitive(const Gltf& gltf, size_t mesh, size_t primitive, bool skinned,
                             std::span<const double> morph_weights);

/// "mesh 3 'door', primitive 0"
std::string place_of_primitive(const Gltf& gltf, size_t mesh, size_t primitive);

/// A triangle list from any glTF mode; `corners` are the primitive's vertices in drawing order.
std::vector<uint32_t> triangle_list(int mode, std::vector<uint32_t> corners);

}  // namespace chandelier::baker
