// SPDX-License-Identifier: Apache-2.0
// Builds vertices from a primitive's attributes.
#pragma once

#include <cstddef>

#include "../scene.h"
#include "draco.h"

namespace chandelier::baker {

/// What the attributes of a primitive are read from.
struct VertexSource {
  const Gltf& gltf;
  const tinygltf::Primitive& primitive;
  const DracoPrimitive* draco;  // holds some of the attributes; may be nullptr
  const std::string& where;
  size_t vertex_count;
  std::span<const double> morph_weights;  // one per morph target, or none
};

/// An attribute's elements, one per vertex; a count of 0 where the primitive has none. Throws Error.
Elements attribute_of(const VertexSource& source, const char* name, size_t least, size_t most);

/// Unit length, or zero where it has no direction.
glm::vec3 unit_or_zero(const glm::vec3& v);

/// Any unit vector orthogonal to the normal.
glm::vec3 some_tangent(const glm::vec3& normal);

/// Fills the primitive's vertices; its indices must be there. Throws Error.
void read_vertices(const VertexSource& source, Primitive& out);

}  // namespace chandelier::baker
