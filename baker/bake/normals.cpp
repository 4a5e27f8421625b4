// SPDX-License-Identifier: Apache-2.0
// Missing normals: flat, or smooth between creases, found by walking around each vertex with OpenMesh.
#include "normals.h"

#include <OpenMesh/Core/Mesh/TriMesh_ArrayKernelT.hh>
#include <algorithm>
#include <cmath>
#include <cstring>

#include "equal.h"

namespace chandelier::baker {
namespace {

struct MeshTraits : OpenMesh::DefaultTraits {
  FaceAttributes(0);
  VertexAttributes(0);
  HalfedgeAttributes(OpenMesh::Attributes::PrevHalfedge);
};
using HalfedgeMesh = OpenMesh::TriMesh_ArrayKernelT<MeshTraits>;
using Halfedge = OpenMesh::HalfedgeHandle;

glm::dvec3 corner(const Primitive& primitive, size_t i) {
  return primitive.vertices[primitive.indices[i]].position_ls;
}

glm::dvec3 unit_or(const glm::dvec3& vector, const glm::dvec3& otherwise) {
  const double length = glm::length(vector);
  return length > 0 && std::isfinite(length) ? vector / length : otherwise;
}

/// Unit length, or zero for a triangle without an area.
glm::dvec3 flat_normal(const Primitive& primitive, size_t triangle) {
  const glm::dvec3 a = corner(primitive, 3 * triangle);
  return unit_or(glm::cross(corner(primitive, 3 * triangle + 1) - a, corner(primitive, 3 * triangle + 2) - a),
                 glm::dvec3(0));
}

/// The angle of a triangle at one of its corners.
double angle_at(const Primitive& primitive, size_t triangle, size_t c) {
  const glm::dvec3 at = corner(primitive, 3 * triangle + c);
  const glm::dvec3 b = corner(primitive, 3 * triangle + (c + 1) % 3) - at;
  const glm::dvec3 d = corner(primitive, 3 * triangle + (c + 2) % 3) - at;
  return std::atan2(glm::length(glm::cross(b, d)), glm::dot(b, d));
}

/// A mesh over the primitive's places, whose face t is triangle t. Where the surface is not a manifold, or a triangle
/// repeats a place, the triangle has vertices of its own.
HalfedgeMesh halfedge_mesh(const Primitive& primitive) {
  [[maybe_unused]] static const bool quiet = (omerr().disable(), true);  // else it prints each such triangle
  const std::vector<Vertex>& vertices = primitive.vertices;
  const auto place = first_equal(
      vertices.size(),
      [&](size_t i) {
        const glm::vec3 p = vertices[i].position_ls + 0.0f;  // -0 is 0
        uint32_t words[3];
        std::memcpy(words, &p, sizeof(words));
        return hash_words(words, 3);
      },
      [&](size_t i, size_t j) { return vertices[i].position_ls == vertices[j].position_ls; });
  HalfedgeMesh mesh;
  mesh.reserve(vertices.size(), primitive.indices.size() / 2, primitive.indices.size() / 3);
  for (size_t i = 0; i < vertices.size(); ++i) mesh.add_vertex({});
  for (size_t i = 0; i + 2 < primitive.indices.size(); i += 3) {
    const OpenMesh::VertexHandle corners[] = {
        OpenMesh::VertexHandle(static_cast<int>(place[primitive.indices[i]])),
        OpenMesh::VertexHandle(static_cast<int>(place[primitive.indices[i + 1]])),
        OpenMesh::VertexHandle(static_cast<int>(place[primitive.indices[i + 2]]))};
    const bool whole = corners[0] != corners[1] && corners[1] != corners[2] && corners[2] != corners[0];
    if (whole && mesh.add_face(corners, 3).is_valid()) continue;
    mesh.add_face(mesh.add_vertex({}), mesh.add_vertex({}), mesh.add_vertex({}));
  }
  return mesh;
}

/// Normals of all corners, smoothed between creases.
class CreaseNormals {
 public:
  CreaseNormals(const Primitive& primitive, double smooth_angle_rad)
      : primitive_(primitive), mesh_(halfedge_mesh(primitive)), least_cosine_(std::cos(smooth_angle_rad)) {
    const size_t triangles = primitive.indices.size() / 3;
    faces_.reserve(triangles);
    for (size_t t = 0; t < triangles; ++t) faces_.push_back(flat_normal(primitive, t));
    normals.assign(3 * triangles, glm::vec3(0));
    std::vector<bool> done(mesh_.n_halfedges(), false);
    for (const Halfedge h : mesh_.halfedges()) {
      if (mesh_.is_boundary(h) || done[static_cast<size_t>(h.idx())]) continue;
      collect_sector(h);
      for (const Halfedge each : sector_) done[static_cast<size_t>(each.idx())] = true;
      smooth_sector();
    }
  }

  std::vector<glm::vec3> normals;

 private:
  size_t face(Halfedge h) const { return static_cast<size_t>(mesh_.face_handle(h).idx()); }

  bool is_crease(Halfedge h) const {
    const Halfedge across = mesh_.opposite_halfedge_handle(h);
    return mesh_.is_boundary(across) || glm::dot(faces_[face(h)], faces_[face(across)]) < least_cosine_ - 1e-12;
  }

  /// The halfedges to one vertex, face after face, from crease to crease or all around.
  void collect_sector(Halfedge from) {
    Halfedge first = from;
    while (!is_crease(first)) {
      const Halfedge before = mesh_.prev_halfedge_handle(mesh_.opposite_halfedge_handle(first));
      if (before == from) break;
      first = before;
    }
    sector_.assign(1, first);
    for (Halfedge h = first;;) {
      const Halfedge out = mesh_.next_halfedge_handle(h);
      if (is_crease(out)) return;
      h = mesh_.opposite_halfedge_handle(out);
      if (h == first) return;
      sector_.push_back(h);
    }
  }

  /// A face's first halfedge ends at its second corner: OpenMesh's add_face begins with the edge 0→1.
  size_t corner_of(Halfedge h) const {
    const Halfedge last = mesh_.halfedge_handle(mesh_.face_handle(h));  // 2→0
    return h == last ? 0 : h == mesh_.next_halfedge_handle(last) ? 1 : 2;
  }

  void smooth_sector() {
    glm::dvec3 sum(0);
    for (const Halfedge h : sector_) sum += faces_[face(h)] * angle_at(primitive_, face(h), corner_of(h));
    for (const Halfedge h : sector_) {
      normals[3 * face(h) + corner_of(h)] = glm::vec3(unit_or(sum, faces_[face(h)]));
    }
  }

  const Primitive& primitive_;
  const HalfedgeMesh mesh_;
  const double least_cosine_;
  std::vector<glm::dvec3> faces_;
  std::vector<Halfedge> sector_;
};

/// Gives corner i the normal `normal_of(i)`. Corners of one vertex with equal normals share a copy of it, if a short
/// search finds it; vertices are welded later anyway.
template <typename NormalOf>
void set_normals(Primitive& primitive, NormalOf normal_of) {
  constexpr int look_ahead = 8;
  std::vector<uint32_t> newest(primitive.vertices.size(), no_index), older;
  std::vector<Vertex> vertices;
  std::vector<SkinVertex> skin_vertices;
  for (size_t i = 0; i < primitive.indices.size(); ++i) {
    const uint32_t from = primitive.indices[i];
    const glm::vec3 normal = normal_of(i);
    uint32_t copy = newest[from];
    for (int look = 0; look < look_ahead && copy != no_index && vertices[copy].normal_ls != normal; ++look)
      copy = older[copy];
    if (copy == no_index || vertices[copy].normal_ls != normal) {
      copy = static_cast<uint32_t>(vertices.size());
      older.push_back(newest[from]);
      newest[from] = copy;
      vertices.push_back(primitive.vertices[from]);
      vertices.back().normal_ls = normal;
      if (!primitive.skin_vertices.empty()) skin_vertices.push_back(primitive.skin_vertices[from]);
    }
    primitive.indices[i] = copy;
  }
  primitive.vertices = std::move(vertices);
  primitive.skin_vertices = std::move(skin_vertices);
}

glm::vec3 or_up(const glm::vec3& normal) {
  return normal == glm::vec3(0) ? glm::vec3(0, 1, 0) : normal;
}

}  // namespace

void make_normals(Primitive& primitive, float smooth_angle_rad) {
  if (smooth_angle_rad > 0) {
    const CreaseNormals creases(primitive, smooth_angle_rad);
    set_normals(primitive, [&](size_t i) { return or_up(creases.normals[i]); });
    return;
  }
  // The corners of a triangle are read before they are replaced.
  glm::vec3 normal(0);
  set_normals(primitive, [&](size_t i) {
    if (i % 3 == 0) normal = or_up(glm::vec3(flat_normal(primitive, i / 3)));
    return normal;
  });
}

size_t make_normals(Scene& scene, float smooth_angle_rad) {
  std::vector<Primitive*> without;
  for (Mesh& mesh : scene.meshes) {
    for (Primitive& primitive : mesh.primitives) {
      if (primitive.needs_normals) without.push_back(&primitive);
    }
  }
  tbb::parallel_for(size_t{0}, without.size(), [&](size_t i) {
    make_normals(*without[i], smooth_angle_rad);
    without[i]->needs_normals = false;
  });
  return without.size();
}

}  // namespace chandelier::baker
