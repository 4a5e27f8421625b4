// SPDX-License-Identifier: Apache-2.0
// Applies morph targets with the file's own weights.
#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <vector>

#include "vertices.h"

namespace chandelier::baker {

/// All different weights of the meshes that nodes show, each once and numbered: a file may name thousands for thousands
/// of nodes in a few bytes each.
class MorphWeights {
 public:
  explicit MorphWeights(const Gltf& gltf) : gltf_(gltf) {}

  /// The number of the weights of the mesh that a node shows: the node's own, else the mesh's. It must have a mesh.
  uint32_t of_node(size_t node);

  /// One per morph target. Empty where all are 0: the base mesh.
  const std::vector<double>& operator[](uint32_t number) const { return *by_number_[number]; }

 private:
  uint32_t number_of(const Json& owner);

  const Gltf& gltf_;
  std::map<std::vector<double>, uint32_t> numbers_;
  std::vector<const std::vector<double>*> by_number_;  // keys of numbers_
  std::map<size_t, uint32_t> of_mesh_;                 // weights of meshes that have been looked up
};

/// Adds the number of vertices that a primitive's targets move to `morphed`, before any of them is read. Throws Error
/// if there is not one weight per target, or above 2^30 vertices.
void add_morph_size(const Gltf& gltf, const tinygltf::Primitive& primitive, std::span<const double> weights,
                    const std::string& where, uint64_t& morphed);

/// Moves the primitive's vertices by its targets, each times its weight. Returns whether a normal has no direction any
/// more. Throws Error.
bool apply_morphs(const VertexSource& source, Primitive& out);

/// The first attribute that weighted targets change but apply_morphs does not, or "".
std::string unread_morph(const VertexSource& source);

}  // namespace chandelier::baker
