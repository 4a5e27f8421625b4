// SPDX-License-Identifier: Apache-2.0
// Meshes between the geometry passes: vertices in the pack's format, on a grid, but not yet welded or in batches.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "../scene.h"
#include "pack_schema.h"

namespace chandelier::baker {

/// pack::Position and pack::VertexAttributes of one vertex. No padding: vertices are compared word by word.
struct PackedVertex {
  glm::vec3 position_ls{0};
  pack::VertexAttributes attributes;
};
static_assert(sizeof(PackedVertex) == sizeof(pack::Position) + sizeof(pack::VertexAttributes));

struct PackedPrimitive {
  std::vector<PackedVertex> vertices;
  std::vector<SkinVertex> skin_vertices;  // one per vertex, or none
  std::vector<uint32_t> indices;          // a triangle list
  std::vector<bool> closed;               // per triangle: whether it may be culled by facing
  uint32_t material = 0;

  size_t triangle_count() const { return indices.size() / 3; }
};

struct PackedMesh {
  std::vector<PackedPrimitive> primitives;  // none where no instance needs them
};

/// The corner c of a triangle.
inline const glm::vec3& corner_of(const PackedPrimitive& primitive, size_t triangle, size_t c) {
  return primitive.vertices[primitive.indices[3 * triangle + c]].position_ls;
}

/// A vector along the normal whose length is twice the area. For corners on a grid of 2^25 steps it is exact, so it is
/// exactly zero for a triangle without area.
inline glm::dvec3 area_vector(const PackedPrimitive& primitive, size_t triangle) {
  const glm::dvec3 a = corner_of(primitive, triangle, 0);
  return glm::cross(glm::dvec3(corner_of(primitive, triangle, 1)) - a,
                    glm::dvec3(corner_of(primitive, triangle, 2)) - a);
}

}  // namespace chandelier::baker
