// SPDX-License-Identifier: Apache-2.0
// The passes in their order.
#include "bake.h"

#include <glm/trigonometric.hpp>
#include <span>

#include "../error.h"
#include "batch_bvh.h"
#include "batches.h"
#include "images.h"
#include "instances.h"
#include "light_bvh.h"
#include "lights.h"
#include "normals.h"
#include "pack_checks.h"
#include "strings.h"
#include "textures.h"
#include "triangle_bvh.h"

namespace chandelier::baker {
namespace {

void describe(const Scene& scene, const BakeSettings& settings, Strings& strings, pack::Contents& pack) {
  pack::BakeInfo& info = pack.bake_info;
  info.batch_triangles = settings.batch_triangles;
  info.range_threshold_lx = settings.range_threshold_lx;
  info.unique_triangles = pack.indices.size() / 3;
  for (std::size_t i = 0; i < pack.batch_instances.size(); ++i) {
    const pack::BatchInstance& record = pack.batch_instances[i];
    info.bounds_min_ws = i ? glm::min(info.bounds_min_ws, record.bounds_min_ws) : record.bounds_min_ws;
    info.bounds_max_ws = i ? glm::max(info.bounds_max_ws, record.bounds_max_ws) : record.bounds_max_ws;
    info.instanced_triangles += pack.batches[record.batch].index_count / 3;
  }
  std::string sources;
  for (const std::string& source : scene.sources) sources += (sources.empty() ? "" : "\n") + source;
  info.source = strings.add(sources);
}

template <typename... Records>
std::uint64_t bytes_of(const std::vector<Records>&... sections) {
  return (std::span(sections).size_bytes() + ...);
}

/// Everything that neither lights nor image bytes touch: what a cache keeps from one bake to the next. Materials are
/// there already.
void bake_geometry(Scene& scene, const BakeSettings& settings, const Progress& progress, Report& report,
                   [[maybe_unused]] Warnings& warnings, Strings& strings, pack::Contents& pack) {
  std::vector<MeshRecords> meshes;
  report.run("normals", [&](PassReport& pass) {
    pass.count("primitives", static_cast<double>(make_normals(scene, glm::radians(settings.smooth_angle_deg))));
  });
  report.run("batches", [&](PassReport& pass) {
    meshes = make_batches(scene, settings.batch_triangles, progress, pack);
    pass.bytes = bytes_of(pack.positions, pack.vertex_attributes, pack.indices, pack.batches, pack.meshes);
    pass.count("batches", static_cast<double>(pack.batches.size()));
  });
  report.run("instances", [&](PassReport& pass) {
    make_instances(scene, meshes, strings, pack);
    pass.bytes = bytes_of(pack.instances, pack.batch_instances);
  });
  report.run("batch_bvh", [&](PassReport& pass) { make_batch_bvh(pass, pack); });
  report.run("instance_bvh", [&](PassReport& pass) { make_instance_bvh(pass, pack); });
  report.run("triangle_bvh", [&](PassReport& pass) { make_triangle_bvh(pass, pack); });
  report.run("voxels", [&](PassReport& pass) { make_voxels(settings.voxels, progress, pack, pass); });
}

void bake_lights(const Scene& scene, const BakeSettings& settings, Report& report, [[maybe_unused]] Warnings& warnings,
                 Strings& strings, pack::Contents& pack) {
  report.run("lights", [&](PassReport& pass) {
    make_lights(scene, settings.range_threshold_lx, strings, pack);
    pass.bytes = bytes_of(pack.lights);
    pass.count("lights", static_cast<double>(pack.lights.size()));
  });
  report.run("light_bvh", [&](PassReport& pass) {
    pack.light_bvh = build_light_bvh(pack.lights);
    pass.bytes = bytes_of(pack.light_bvh);
    pass.count("nodes", static_cast<double>(pack.light_bvh.size()));
  });
}

}  // namespace

pack::Contents bake(Scene&& scene, const BakeSettings& settings, const Progress& progress, Report& report,
                    Warnings& warnings) {
  pack::Contents pack;
  Strings strings(pack.strings);
  std::vector<ImageRequest> requests;
  report.run("materials", [&](PassReport& pass) {
    requests = make_materials(scene, strings, pack);
    pass.bytes = bytes_of(pack.materials, pack.textures);
  });
  bake_geometry(scene, settings, progress, report, warnings, strings, pack);
  report.run("images", [&](PassReport& pass) {
    make_images(scene, requests, progress, strings, pack);
    pass.bytes = bytes_of(pack.images, pack.image_data);
  });
  bake_lights(scene, settings, report, warnings, strings, pack);
  make_cameras(scene, strings, pack);
  describe(scene, settings, strings, pack);
  report.run("check", [&](PassReport&) {
    const std::string fault = pack::check(pack::view_of(pack));
    if (!fault.empty()) fail("scene", "cannot be stored in a pack: " + fault);
  });
  return pack;
}

}  // namespace chandelier::baker
