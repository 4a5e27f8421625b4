// SPDX-License-Identifier: Apache-2.0
// normals → tangents → quantize → weld → clean → shells → batches, each over all meshes at once.
#include "mesh_passes.h"

#include <tbb/parallel_for.h>

#include <glm/trigonometric.hpp>
#include <span>

#include "clean.h"
#include "normals.h"
#include "quantize.h"
#include "shells.h"
#include "tangents.h"
#include "weld.h"

namespace chandelier::baker {
namespace {

using Meshes = std::vector<PackedMesh>;

void count(PassReport& pass, const char* what, uint64_t value) {
  pass.count(what, static_cast<double>(value));
}

template <typename Member>
uint64_t sum(const Meshes& meshes, Member member) {
  uint64_t total = 0;
  for (const PackedMesh& mesh : meshes) {
    for (const PackedPrimitive& primitive : mesh.primitives) total += member(primitive);
  }
  return total;
}

uint64_t vertex_count(const Meshes& meshes) {
  return sum(meshes, [](const PackedPrimitive& primitive) { return primitive.vertices.size(); });
}

uint64_t triangle_count(const Meshes& meshes) {
  return sum(meshes, [](const PackedPrimitive& primitive) { return primitive.triangle_count(); });
}

void weld_all(Meshes& meshes, PassReport& pass) {
  const uint64_t before = vertex_count(meshes);
  tbb::parallel_for(size_t{0}, meshes.size(), [&](size_t m) {
    std::vector<PackedPrimitive>& primitives = meshes[m].primitives;
    tbb::parallel_for(size_t{0}, primitives.size(), [&](size_t p) { weld(primitives[p]); });
  });
  count(pass, "vertices", vertex_count(meshes));
  count(pass, "welded", before - vertex_count(meshes));
}

bool is_rigid(const PackedMesh& mesh) {
  for (const PackedPrimitive& primitive : mesh.primitives) {
    if (!primitive.skin_vertices.empty()) return false;
  }
  return true;
}

void clean_all(Meshes& meshes, const std::vector<Material>& materials, PassReport& pass) {
  std::vector<CleanCounts> counts(meshes.size());
  tbb::parallel_for(size_t{0}, meshes.size(),
                    [&](size_t m) { counts[m] = clean(meshes[m], materials, is_rigid(meshes[m])); });
  CleanCounts all;
  for (const CleanCounts& each : counts) {
    all.degenerate += each.degenerate;
    all.duplicate += each.duplicate;
  }
  count(pass, "triangles", triangle_count(meshes));
  count(pass, "degenerate", all.degenerate);
  count(pass, "duplicate", all.duplicate);
}

void find_all_shells(Meshes& meshes, const std::vector<Material>& materials, PassReport& pass) {
  std::vector<ShellCounts> counts(meshes.size());
  tbb::parallel_for(size_t{0}, meshes.size(),
                    [&](size_t m) { counts[m] = find_shells(meshes[m], materials, is_rigid(meshes[m])); });
  ShellCounts all;
  for (const ShellCounts& each : counts) {
    all.shells += each.shells;
    all.closed += each.closed;
    all.closed_triangles += each.closed_triangles;
  }
  count(pass, "shells", all.shells);
  count(pass, "closed", all.closed);
  count(pass, "closed_triangles", all.closed_triangles);
}

void report_batches(const pack::Contents& pack, PassReport& pass) {
  uint64_t closed = 0, cones = 0;
  for (const pack::Batch& batch : pack.batches) {
    closed += batch.closed;
    cones += batch.cone_cutoff < 1;
  }
  count(pass, "batches", pack.batches.size());
  count(pass, "closed", closed);
  count(pass, "with_cone", cones);
  count(pass, "vertices", pack.positions.size());
  count(pass, "triangles", pack.indices.size() / 3);
  pass.bytes = std::span(pack.positions).size_bytes() + std::span(pack.vertex_attributes).size_bytes() +
               std::span(pack.skin_vertices).size_bytes() + std::span(pack.indices).size_bytes() +
               std::span(pack.batches).size_bytes() + std::span(pack.meshes).size_bytes();
}

}  // namespace

std::vector<MeshRecords> bake_meshes(Scene& scene, const BakeSettings& settings, Report& report, pack::Contents& pack) {
  report.run("normals", [&](PassReport& pass) {
    count(pass, "primitives", make_normals(scene, glm::radians(settings.smooth_angle_deg)));
  });
  report.run("tangents", [&](PassReport& pass) { count(pass, "primitives", make_tangents(scene)); });
  Meshes meshes;
  report.run("quantize", [&](PassReport& pass) {
    meshes = quantize(scene, {settings.position_error_m, settings.normal_bits, settings.uv_bits}, pack.bake_info);
    pass.count("position_error_m", pack.bake_info.position_error_m);
    pass.count("normal_error_rad", pack.bake_info.normal_error_rad);
    pass.count("uv_error", pack.bake_info.uv_error);
  });
  report.run("weld", [&](PassReport& pass) { weld_all(meshes, pass); });
  report.run("clean", [&](PassReport& pass) { clean_all(meshes, scene.materials, pass); });
  report.run("shells", [&](PassReport& pass) { find_all_shells(meshes, scene.materials, pass); });
  std::vector<MeshRecords> records;
  report.run("batches", [&](PassReport& pass) {
    records = make_batches(scene, meshes, settings.batch_triangles, pack);
    report_batches(pack, pass);
  });
  return records;
}

}  // namespace chandelier::baker
