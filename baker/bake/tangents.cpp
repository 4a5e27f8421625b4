// SPDX-License-Identifier: Apache-2.0
// Tangents: each triangle's direction of growing u, summed at its vertices (weighted by angle) and made orthogonal to
// the normal. The sign w is that of glTF: bitangent = cross(normal, tangent) * w points the way the normal map's green
// does.
#include "tangents.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

#include "weld.h"

namespace chandelier::baker {
namespace {

struct TriangleFrame {
  glm::dvec3 tangent{0};
  bool mirrored = false;
};

glm::dvec2 uv_of(const Vertex& vertex, bool uv1) {
  return uv1 ? vertex.uv1 : vertex.uv0;
}

TriangleFrame triangle_frame(const Vertex& a, const Vertex& b, const Vertex& c, bool uv1) {
  const glm::dvec3 ab = glm::dvec3(b.position_ls) - glm::dvec3(a.position_ls);
  const glm::dvec3 ac = glm::dvec3(c.position_ls) - glm::dvec3(a.position_ls);
  const glm::dvec2 duv_ab = uv_of(b, uv1) - uv_of(a, uv1), duv_ac = uv_of(c, uv1) - uv_of(a, uv1);
  const double area = duv_ab.x * duv_ac.y - duv_ac.x * duv_ab.y;
  if (area == 0) return {};
  const glm::dvec3 tangent = (ab * duv_ac.y - ac * duv_ab.y) / area;
  const double length = glm::length(tangent);
  // glTF's v points down while a normal map's green points up: on an unmirrored surface, where u, up and the normal are
  // right-handed, the uv area seen from the front is negative.
  return {length > 0 && std::isfinite(length) ? tangent / length : glm::dvec3(0), area > 0};
}

double angle_at(const Vertex& at, const Vertex& b, const Vertex& c) {
  const glm::dvec3 to_b = glm::dvec3(b.position_ls) - glm::dvec3(at.position_ls);
  const glm::dvec3 to_c = glm::dvec3(c.position_ls) - glm::dvec3(at.position_ls);
  const double lengths = glm::length(to_b) * glm::length(to_c);
  return lengths > 0 ? std::acos(std::clamp(glm::dot(to_b, to_c) / lengths, -1.0, 1.0)) : 0;
}

/// `sum` made orthogonal to the normal, or any direction orthogonal to it.
glm::vec3 across(const glm::vec3& normal, const glm::dvec3& sum) {
  const glm::dvec3 n = normal;
  glm::dvec3 tangent = sum - n * glm::dot(n, sum);
  if (!(glm::length(tangent) > 1e-9)) {
    const glm::dvec3 axis = std::abs(n.x) < 0.9 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0);
    tangent = axis - n * glm::dot(n, axis);
  }
  return glm::vec3(glm::normalize(tangent));
}

/// Vertices by the side on which they are used: number of a vertex's copy, per vertex and side.
class SidedVertices {
 public:
  explicit SidedVertices(const Primitive& in) : in_(in), number_(2 * in.vertices.size(), no_index) {}

  uint32_t use(uint32_t vertex, bool mirrored) {
    uint32_t& number = number_[2 * size_t{vertex} + mirrored];
    if (number == no_index) {
      number = static_cast<uint32_t>(vertices.size());
      vertices.push_back(in_.vertices[vertex]);
      if (!in_.skin_vertices.empty()) skin_vertices.push_back(in_.skin_vertices[vertex]);
      vertices.back().tangent_ls.w = mirrored ? -1.0f : 1.0f;
      sums.emplace_back(0);
    }
    return number;
  }

  std::vector<Vertex> vertices;
  std::vector<SkinVertex> skin_vertices;
  std::vector<glm::dvec3> sums;

 private:
  const Primitive& in_;
  std::vector<uint32_t> number_;
};

}  // namespace

void make_tangents(Primitive& primitive) {
  SidedVertices sided(primitive);
  for (size_t t = 0; t + 2 < primitive.indices.size(); t += 3) {
    const uint32_t corners[] = {primitive.indices[t], primitive.indices[t + 1], primitive.indices[t + 2]};
    const Vertex* v[] = {&primitive.vertices[corners[0]], &primitive.vertices[corners[1]],
                         &primitive.vertices[corners[2]]};
    const TriangleFrame frame = triangle_frame(*v[0], *v[1], *v[2], primitive.tangents_from_uv1);
    for (int c = 0; c < 3; ++c) {
      const uint32_t number = sided.use(corners[c], frame.mirrored);
      sided.sums[number] += frame.tangent * angle_at(*v[c], *v[(c + 1) % 3], *v[(c + 2) % 3]);
      primitive.indices[t + c] = number;
    }
  }
  for (size_t i = 0; i < sided.vertices.size(); ++i) {
    Vertex& vertex = sided.vertices[i];
    vertex.tangent_ls = glm::vec4(across(vertex.normal_ls, sided.sums[i]), vertex.tangent_ls.w);
  }
  primitive.vertices = std::move(sided.vertices);
  primitive.skin_vertices = std::move(sided.skin_vertices);
}

size_t make_tangents(Scene& scene) {
  std::vector<Primitive*> without;
  for (Mesh& mesh : scene.meshes) {
    for (Primitive& primitive : mesh.primitives) {
      if (primitive.needs_tangents) without.push_back(&primitive);
    }
  }
  tbb::parallel_for(size_t{0}, without.size(), [&](size_t i) {
    weld(*without[i]);
    make_tangents(*without[i]);
    without[i]->needs_tangents = false;
  });
  return without.size();
}

}  // namespace chandelier::baker
