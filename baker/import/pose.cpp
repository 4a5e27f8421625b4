// SPDX-License-Identifier: Apache-2.0
// glTF 2.0, 3.7.3.3: a vertex moves by the sum of its weights times its joints' matrices, its normal by the inverse
// transpose of that. Where that mirrors, front and back are swapped: the triangles are turned around.
#include "pose.h"

#include <cmath>

#include "../error.h"
#include "accessor.h"
#include "vertices.h"

namespace chandelier::baker {
namespace {

glm::dmat4 blended(const Pose& pose, const SkinVertex& vertex) {
  glm::dmat4 out(0);
  for (size_t k = 0; k < 4; ++k) {
    if (vertex.weights[k] != 0) out += pose.world_from_bind[vertex.joints[k]] * (vertex.weights[k] / 65535.0);
  }
  return out;
}

/// The columns' cross products: the inverse transpose times the determinant, of any matrix.
glm::dmat3 cofactors(const glm::dmat3& m) {
  return {glm::cross(m[1], m[2]), glm::cross(m[2], m[0]), glm::cross(m[0], m[1])};
}

/// Returns -1 where the vertex's surroundings are mirrored, else 1.
int move(const Pose& pose, const SkinVertex& bound, Vertex& vertex) {
  const glm::dmat4 world = blended(pose, bound);
  const int side = glm::determinant(glm::dmat3(world)) < 0 ? -1 : 1;
  vertex.position_ls = glm::vec3(glm::dvec3(world * glm::dvec4(vertex.position_ls, 1)) - pose.origin_ws);
  const glm::dvec3 normal = cofactors(glm::dmat3(world)) * glm::dvec3(vertex.normal_ls) * double(side);
  const double length = glm::length(normal);
  if (length > 0 && std::isfinite(length)) vertex.normal_ls = glm::vec3(normal / length);  // else any normal will do
  const glm::dvec3 tangent = glm::dmat3(world) * glm::dvec3(vertex.tangent_ls);
  const double stretch = glm::length(tangent);
  const bool has_tangent = stretch > 0 && std::isfinite(stretch);
  vertex.tangent_ls = glm::vec4(has_tangent ? glm::vec3(tangent / stretch) : some_tangent(vertex.normal_ls),
                                vertex.tangent_ls.w * static_cast<float>(side));
  return side;
}

}  // namespace

void apply_pose(const Pose& pose, const std::string& where, Mesh& mesh) {
  for (Primitive& primitive : mesh.primitives) {
    std::vector<int8_t> sides(primitive.vertices.size());
    FirstFault beyond;
    for_blocks(sides.size(), [&](size_t first, size_t count) {
      for (size_t i = first; i < first + count; ++i) {
        Vertex& vertex = primitive.vertices[i];
        sides[i] = static_cast<int8_t>(move(pose, primitive.skin_vertices[i], vertex));
        const glm::vec3& p = vertex.position_ls;
        if (!std::isfinite(p.x) || !std::isfinite(p.y) || !std::isfinite(p.z)) beyond.note(i);
      }
    });
    if (beyond.at() != SIZE_MAX) {
      fail(where, "its skin moves a vertex to a position that is too large for a float (vertex " +
                      std::to_string(beyond.at()) + ")");
    }
    for (size_t i = 0; i + 2 < primitive.indices.size(); i += 3) {
      uint32_t* corner = &primitive.indices[i];
      if (sides[corner[0]] + sides[corner[1]] + sides[corner[2]] < 0) std::swap(corner[1], corner[2]);
    }
    primitive.skin_vertices.clear();
  }
}

}  // namespace chandelier::baker
