// SPDX-License-Identifier: Apache-2.0
// Batches: welded, with tangents, cut by meshoptimizer, concatenated in the order of meshes and primitives.
#include "batches.h"

#include <meshoptimizer.h>
#include <tbb/parallel_for.h>

#include "../error.h"
#include "octahedral.h"
#include "tangents.h"
#include "weld.h"

namespace chandelier::baker {
namespace {

/// Triangles in the order of their batches.
struct CutPrimitive {
  std::vector<Vertex> vertices;
  std::vector<std::uint32_t> indices;
  std::vector<std::uint32_t> triangle_counts;  // of each batch
  std::uint32_t material = 0;
};

constexpr std::size_t kBatchVertices = 255;  // meshoptimizer's limit

struct Meshlets {
  std::vector<meshopt_Meshlet> meshlets;
  std::vector<std::uint32_t> vertices;
  std::vector<std::uint8_t> corners;
};

std::size_t triangle_count(const Meshlets& pieces) {
  std::size_t count = 0;
  for (const meshopt_Meshlet& meshlet : pieces.meshlets) count += meshlet.triangle_count;
  return count;
}

/// Whether a vertex has so many triangles that meshoptimizer, which looks at all of them for each one that it takes,
/// would need time quadratic in them: 29 s for a fan of 100 000.
bool has_hub(const std::vector<std::uint32_t>& indices, std::size_t vertex_count) {
  constexpr std::uint32_t kMostTriangles = 1000;
  std::vector<std::uint32_t> triangles(vertex_count, 0);
  for (const std::uint32_t vertex : indices) {
    if (++triangles[vertex] > kMostTriangles) return true;
  }
  return false;
}

Meshlets build_meshlets(const std::vector<std::uint32_t>& indices, const std::vector<Vertex>& vertices,
                        std::size_t batch_triangles) {
  const std::size_t bound = meshopt_buildMeshletsBound(indices.size(), kBatchVertices, batch_triangles);
  const auto with_room = [&] {
    return Meshlets{std::vector<meshopt_Meshlet>(bound), std::vector<std::uint32_t>(bound * kBatchVertices),
                    std::vector<std::uint8_t>(bound * batch_triangles * 3)};
  };
  const auto scan = [&](const std::vector<std::uint32_t>& order) {
    Meshlets out = with_room();
    out.meshlets.resize(meshopt_buildMeshletsScan(out.meshlets.data(), out.vertices.data(), out.corners.data(),
                                                  order.data(), order.size(), vertices.size(), kBatchVertices,
                                                  batch_triangles));
    return out;
  };
  if (has_hub(indices, vertices.size())) {
    std::vector<std::uint32_t> order(indices.size());
    meshopt_spatialSortTriangles(order.data(), indices.data(), indices.size(), &vertices[0].position_ls.x,
                                 vertices.size(), sizeof(Vertex));
    return scan(order);
  }
  std::vector<std::uint32_t> order(indices.size());
  meshopt_optimizeVertexCache(order.data(), indices.data(), indices.size(), vertices.size());
  Meshlets out = with_room();
  out.meshlets.resize(meshopt_buildMeshlets(out.meshlets.data(), out.vertices.data(), out.corners.data(), order.data(),
                                            order.size(), &vertices[0].position_ls.x, vertices.size(), sizeof(Vertex),
                                            kBatchVertices, batch_triangles, 0.0f));
  if (triangle_count(out) == indices.size() / 3) return out;
  // Where squares of distances overflow (1e20 m), it leaves triangles out: cut in the order they come.
  return scan(order);
}

CutPrimitive cut(Primitive&& primitive, std::size_t batch_triangles) {
  weld(primitive);
  if (primitive.needs_tangents) make_tangents(primitive);
  CutPrimitive out;
  out.material = primitive.material;
  if (primitive.indices.empty()) return out;
  const Meshlets pieces = build_meshlets(primitive.indices, primitive.vertices, batch_triangles);
  for (const meshopt_Meshlet& meshlet : pieces.meshlets) {
    for (std::size_t i = 0; i < std::size_t{meshlet.triangle_count} * 3; ++i) {
      out.indices.push_back(pieces.vertices[meshlet.vertex_offset + pieces.corners[meshlet.triangle_offset + i]]);
    }
    out.triangle_counts.push_back(meshlet.triangle_count);
  }
  out.vertices.resize(primitive.vertices.size());
  out.vertices.resize(meshopt_optimizeVertexFetch(out.vertices.data(), out.indices.data(), out.indices.size(),
                                                  primitive.vertices.data(), primitive.vertices.size(),
                                                  sizeof(Vertex)));
  return out;
}

void append_vertices(const std::vector<Vertex>& vertices, pack::Contents& pack) {
  for (const Vertex& vertex : vertices) {
    pack.positions.push_back({vertex.position_ls});
    pack.vertex_attributes.push_back({pack::encode_normal(vertex.normal_ls), pack::encode_tangent(vertex.tangent_ls),
                                      vertex.uv0, vertex.uv1, vertex.color});
  }
}

/// Appends a primitive's batches; its vertices start at `first_vertex` in the pack.
void append_batches(const CutPrimitive& cut, std::uint32_t first_vertex, bool mirrored, pack::Contents& pack) {
  const std::uint32_t* corner = cut.indices.data();
  for (const std::uint32_t triangles : cut.triangle_counts) {
    pack::Batch batch;
    batch.material = cut.material;
    batch.first_index = static_cast<std::uint32_t>(pack.indices.size());
    batch.index_count = triangles * 3;
    batch.cone_cutoff = 1;
    batch.bounds_min_ls = batch.bounds_max_ls = cut.vertices[*corner].position_ls;
    for (std::uint32_t t = 0; t < triangles; ++t, corner += 3) {
      for (const int c : {0, mirrored ? 2 : 1, mirrored ? 1 : 2}) {
        const glm::vec3& position = cut.vertices[corner[c]].position_ls;
        batch.bounds_min_ls = glm::min(batch.bounds_min_ls, position);
        batch.bounds_max_ls = glm::max(batch.bounds_max_ls, position);
        pack.indices.push_back({first_vertex + corner[c]});
      }
    }
    pack.batches.push_back(batch);
  }
}

void include(const pack::Batch& batch, pack::Mesh& mesh) {
  const bool first = mesh.batch_count++ == 0;
  mesh.bounds_min_ls = first ? batch.bounds_min_ls : glm::min(mesh.bounds_min_ls, batch.bounds_min_ls);
  mesh.bounds_max_ls = first ? batch.bounds_max_ls : glm::max(mesh.bounds_max_ls, batch.bounds_max_ls);
}

struct MeshUse {
  bool plain = false;
  bool mirrored = false;
};

std::vector<MeshUse> mesh_uses(const Scene& scene) {
  std::vector<MeshUse> uses(scene.meshes.size());
  for (const MeshInstance& instance : scene.instances) {
    (is_mirrored(instance) ? uses[instance.mesh].mirrored : uses[instance.mesh].plain) = true;
  }
  return uses;
}

}  // namespace

bool is_mirrored(const MeshInstance& instance) {
  return glm::determinant(glm::dmat3(instance.world_from_local)) < 0;
}

std::vector<MeshRecords> make_batches(Scene& scene, std::uint32_t batch_triangles, const Progress& progress,
                                      pack::Contents& pack) {
  std::vector<Primitive*> primitives;
  for (Mesh& mesh : scene.meshes) {
    for (Primitive& primitive : mesh.primitives) primitives.push_back(&primitive);
  }
  progress.next("cutting " + std::to_string(primitives.size()) + " primitives into batches");
  std::vector<CutPrimitive> cuts(primitives.size());
  tbb::parallel_for(std::size_t{0}, primitives.size(),
                    [&](std::size_t i) { cuts[i] = cut(std::move(*primitives[i]), batch_triangles); });

  const std::vector<MeshUse> uses = mesh_uses(scene);
  std::vector<MeshRecords> out(scene.meshes.size());
  std::size_t next = 0;
  for (std::size_t m = 0; m < scene.meshes.size(); ++m) {
    const std::size_t first_cut = next;
    const auto first_vertex = static_cast<std::uint32_t>(pack.positions.size());
    std::vector<std::uint32_t> first_vertices;
    for (std::size_t p = 0; p < scene.meshes[m].primitives.size(); ++p, ++next) {
      first_vertices.push_back(static_cast<std::uint32_t>(pack.positions.size()));
      append_vertices(cuts[next].vertices, pack);
      fit_u32(pack.positions.size(), "vertices");
    }
    pack::Mesh record;
    record.first_vertex = first_vertex;
    record.vertex_count = static_cast<std::uint32_t>(pack.positions.size()) - first_vertex;
    for (const bool mirrored : {false, true}) {
      if (!(mirrored ? uses[m].mirrored : uses[m].plain)) continue;
      record.first_batch = static_cast<std::uint32_t>(pack.batches.size());
      record.batch_count = 0;
      for (std::size_t i = first_cut; i < next; ++i) {
        fit_u32(pack.indices.size() + cuts[i].indices.size(), "triangle corners");
        append_batches(cuts[i], first_vertices[i - first_cut], mirrored, pack);
      }
      fit_u32(pack.batches.size(), "batches");
      for (std::size_t b = record.first_batch; b < pack.batches.size(); ++b) include(pack.batches[b], record);
      if (record.batch_count == 0) continue;
      (mirrored ? out[m].mirrored : out[m].plain) = static_cast<std::uint32_t>(pack.meshes.size());
      pack.meshes.push_back(record);
    }
    for (std::size_t i = first_cut; i < next; ++i) cuts[i] = {};
  }
  return out;
}

}  // namespace chandelier::baker
