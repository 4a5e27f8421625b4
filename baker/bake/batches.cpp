// SPDX-License-Identifier: Apache-2.0
// Batches, concatenated in the order of meshes and primitives. Their positions are counted first, so that all can be
// written in parallel.
#include "batches.h"

#include <tbb/parallel_for.h>

#include "../error.h"
#include "batch_cone.h"
#include "batch_cut.h"

namespace chandelier::baker {
namespace {

/// The position of a primitive in the pack's sections.
struct Place {
  size_t vertex = 0, skin_vertex = 0;
  bool skinned = false;  // whether a skin bends the mesh
  struct Copy {
    bool wanted = false;
    size_t index = 0, batch = 0;
  } copies[2];  // as modelled, mirrored
};

struct MeshUse {
  bool copies[2] = {false, false};  // as modelled, mirrored
};

std::vector<MeshUse> mesh_uses(const Scene& scene) {
  std::vector<MeshUse> uses(scene.meshes.size());
  for (const MeshInstance& instance : scene.instances) uses[instance.mesh].copies[is_mirrored(instance)] = true;
  return uses;
}

bool is_skinned(const std::vector<CutPrimitive>& mesh) {
  for (const CutPrimitive& primitive : mesh) {
    if (!primitive.skin_vertices.empty()) return true;
  }
  return false;
}

pack::SkinVertex record_of(const SkinVertex& in) {
  pack::SkinVertex out;
  for (size_t i = 0; i < 2; ++i) {
    out.joints[i] = in.joints[2 * i] | uint32_t{in.joints[2 * i + 1]} << 16;
    out.weights[i] = in.weights[2 * i] | uint32_t{in.weights[2 * i + 1]} << 16;
  }
  return out;
}

void write_vertices(const CutPrimitive& cut, const Place& place, pack::Contents& pack) {
  constexpr SkinVertex unbound = {{}, {65535, 0, 0, 0}};
  tbb::parallel_for(tbb::blocked_range<size_t>(0, cut.vertex_order.size(), 8192), [&](const auto& range) {
    for (size_t i = range.begin(); i < range.end(); ++i) {
      const uint32_t from = cut.vertex_order[i];
      pack.positions[place.vertex + i] = {cut.vertices[from].position_ls};
      pack.vertex_attributes[place.vertex + i] = cut.vertices[from].attributes;
      if (!place.skinned) continue;
      pack.skin_vertices[place.skin_vertex + i] =
          record_of(cut.skin_vertices.empty() ? unbound : cut.skin_vertices[from]);
    }
  });
}

/// Bounds and cone, from the corners of a batch. A batch that a skin bends has no valid cone.
void measure(std::span<const glm::vec3> corners, bool skinned, pack::Batch& batch) {
  batch.bounds_min_ls = batch.bounds_max_ls = corners[0];
  for (const glm::vec3& corner : corners) {
    batch.bounds_min_ls = glm::min(batch.bounds_min_ls, corner);
    batch.bounds_max_ls = glm::max(batch.bounds_max_ls, corner);
  }
  const NormalCone cone = skinned ? NormalCone{} : normal_cone(corners);
  batch.cone_apex_ls = cone.apex;
  batch.cone_axis_ls = cone.axis;
  batch.cone_cutoff = cone.cutoff;
}

/// Writes a primitive's batches and their corners.
void write_batches(const CutPrimitive& cut, const Place& place, bool mirrored, pack::Contents& pack) {
  const Place::Copy& copy = place.copies[mirrored];
  std::vector<size_t> first(cut.batch_counts.size() + 1, 0);
  for (size_t b = 0; b < cut.batch_counts.size(); ++b) first[b + 1] = first[b] + 3 * cut.batch_counts[b];
  tbb::parallel_for(tbb::blocked_range<size_t>(0, cut.batch_counts.size(), 64), [&](const auto& range) {
    std::vector<glm::vec3> corners;
    for (size_t b = range.begin(); b < range.end(); ++b) {
      pack::Batch& batch = pack.batches[copy.batch + b];
      batch.material = cut.material;
      batch.closed = b < cut.closed_batches;
      batch.first_index = static_cast<uint32_t>(copy.index + first[b]);
      batch.index_count = 3 * cut.batch_counts[b];
      corners.clear();
      for (size_t i = first[b]; i < first[b + 1]; ++i) {
        const size_t from = !mirrored || i % 3 == 0 ? i : i % 3 == 1 ? i + 1 : i - 1;
        pack.indices[copy.index + i] = {static_cast<uint32_t>(place.vertex + cut.indices[from])};
        corners.push_back(cut.vertices[cut.vertex_order[cut.indices[from]]].position_ls);
      }
      measure(corners, place.skinned, batch);
    }
  });
}

void include(const pack::Batch& batch, pack::Mesh& mesh) {
  const bool first = mesh.batch_count++ == 0;
  mesh.bounds_min_ls = first ? batch.bounds_min_ls : glm::min(mesh.bounds_min_ls, batch.bounds_min_ls);
  mesh.bounds_max_ls = first ? batch.bounds_max_ls : glm::max(mesh.bounds_max_ls, batch.bounds_max_ls);
}

/// Counts where everything goes, and makes room for it in the pack.
std::vector<std::vector<Place>> find_places(const std::vector<std::vector<CutPrimitive>>& meshes,
                                            const std::vector<MeshUse>& uses, pack::Contents& pack) {
  std::vector<std::vector<Place>> places(meshes.size());
  size_t vertices = 0, skin_vertices = 0, indices = 0, batches = 0;
  for (size_t m = 0; m < meshes.size(); ++m) {
    const bool skinned = is_skinned(meshes[m]);
    for (const CutPrimitive& cut : meshes[m]) {
      places[m].push_back({.vertex = vertices, .skin_vertex = skin_vertices, .skinned = skinned, .copies = {}});
      vertices += cut.vertex_order.size();
      if (skinned) skin_vertices += cut.vertex_order.size();
    }
    for (const int copy : {0, 1}) {
      for (size_t p = 0; p < meshes[m].size() && uses[m].copies[copy]; ++p) {
        places[m][p].copies[copy] = {true, indices, batches};
        indices += meshes[m][p].indices.size();
        batches += meshes[m][p].batch_counts.size();
      }
    }
  }
  pack.positions.resize(fit_u32(vertices, "vertices"));
  pack.vertex_attributes.resize(vertices);
  pack.skin_vertices.resize(skin_vertices);
  pack.indices.resize(fit_u32(indices, "triangle corners"));
  pack.batches.resize(fit_u32(batches, "batches"));
  return places;
}

/// The record of one copy of a mesh; it has no batches if the copy is not needed.
pack::Mesh mesh_record(const std::vector<CutPrimitive>& cuts, const std::vector<Place>& places, int copy,
                       const pack::Contents& pack) {
  pack::Mesh record;
  if (cuts.empty() || !places[0].copies[copy].wanted) return record;
  record.first_vertex = static_cast<uint32_t>(places[0].vertex);
  record.first_skin_vertex = static_cast<uint32_t>(places[0].skin_vertex);
  record.first_batch = static_cast<uint32_t>(places[0].copies[copy].batch);
  for (size_t p = 0; p < cuts.size(); ++p) {
    record.vertex_count += static_cast<uint32_t>(cuts[p].vertex_order.size());
    for (size_t b = 0; b < cuts[p].batch_counts.size(); ++b) {
      include(pack.batches[places[p].copies[copy].batch + b], record);
    }
  }
  record.skin_vertex_count = places[0].skinned ? record.vertex_count : 0;
  return record;
}

}  // namespace

bool is_mirrored(const MeshInstance& instance) {
  return glm::determinant(glm::dmat3(instance.world_from_local)) < 0;
}

std::vector<MeshRecords> make_batches(const Scene& scene, std::vector<PackedMesh>& meshes, uint32_t batch_triangles,
                                      pack::Contents& pack) {
  std::vector<std::vector<CutPrimitive>> cuts(meshes.size());
  tbb::parallel_for(size_t{0}, meshes.size(), [&](size_t m) {
    std::vector<PackedPrimitive>& primitives = meshes[m].primitives;
    cuts[m].resize(primitives.size());
    tbb::parallel_for(size_t{0}, primitives.size(),
                      [&](size_t p) { cuts[m][p] = cut_into_batches(std::move(primitives[p]), batch_triangles); });
  });
  meshes.clear();
  const std::vector<std::vector<Place>> places = find_places(cuts, mesh_uses(scene), pack);

  std::vector<std::array<pack::Mesh, 2>> records(cuts.size());
  tbb::parallel_for(size_t{0}, cuts.size(), [&](size_t m) {
    tbb::parallel_for(size_t{0}, cuts[m].size(), [&](size_t p) {
      write_vertices(cuts[m][p], places[m][p], pack);
      for (const bool mirrored : {false, true}) {
        if (places[m][p].copies[mirrored].wanted) write_batches(cuts[m][p], places[m][p], mirrored, pack);
      }
    });
    for (const int copy : {0, 1}) records[m][copy] = mesh_record(cuts[m], places[m], copy, pack);
    cuts[m] = {};
  });

  std::vector<MeshRecords> out(records.size());
  for (size_t m = 0; m < records.size(); ++m) {
    for (const int copy : {0, 1}) {
      if (records[m][copy].batch_count == 0) continue;
      (copy ? out[m].mirrored : out[m].plain) = static_cast<uint32_t>(pack.meshes.size());
      pack.meshes.push_back(records[m][copy]);
    }
  }
  return out;
}

}  // namespace chandelier::baker
