// SPDX-License-Identifier: Apache-2.0
// The passes in their order.
#include "bake.h"

#include <algorithm>
#include <span>

#include "../error.h"
#include "animation.h"
#include "batch_bvh.h"
#include "geometry_cache.h"
#include "glass.h"
#include "images.h"
#include "instances.h"
#include "light_audit.h"
#include "light_bvh.h"
#include "lights.h"
#include "mesh_passes.h"
#include "pack_checks.h"
#include "recentre.h"
#include "stage_keys.h"
#include "strings.h"
#include "textures.h"
#include "threads.h"
#include "throws_shadow.h"
#include "triangle_bvh.h"

namespace chandelier::baker {
namespace {

void describe(const Scene& scene, const BakeSettings& settings, Strings& strings, pack::Contents& pack) {
  pack::BakeInfo& info = pack.bake_info;
  info.origin_m = scene.origin_m;
  info.batch_triangles = settings.batch_triangles;
  info.range_threshold_lx = settings.range_threshold_lx;
  info.unique_triangles = pack.indices.size() / 3;
  for (size_t i = 0; i < pack.batch_instances.size(); ++i) {
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
uint64_t bytes_of(const std::vector<Records>&... sections) {
  return (std::span(sections).size_bytes() + ...);
}

/// Bakes everything that depends neither on lights nor on image bytes; a cache keeps the result. Materials and nodes
/// are in the pack already.
void bake_geometry(Scene& scene, const BakeSettings& settings, const Progress& progress, Report& report,
                   Strings& strings, pack::Contents& pack) {
  const std::vector<MeshRecords> meshes = bake_meshes(scene, settings, report, pack);
  report.run("instances", [&](PassReport& pass) {
    make_instances(scene, meshes, strings, pack);
    pass.bytes = bytes_of(pack.instances, pack.batch_instances);
    pass.count("shadowless_batches", static_cast<double>(std::count_if(
                                         pack.batch_instances.begin(), pack.batch_instances.end(),
                                         [&](const auto& placed) { return !pack::throws_shadow(pack, placed); })));
  });
  report.run("batch_bvh", [&](PassReport& pass) { make_batch_bvh(pass, pack); });
  report.run("instance_bvh", [&](PassReport& pass) { make_instance_bvh(pass, pack); });
  report.run("triangle_bvh", [&](PassReport& pass) { make_triangle_bvh(pass, pack); });
  report.run("voxels", [&](PassReport& pass) { make_voxels(settings.voxels, progress, pack, pass); });
}

/// Takes the geometry from the cache, or bakes and stores it.
void find_or_bake_geometry(Scene& scene, const BakeSettings& settings, const Progress& progress, Report& report,
                           Cache& cache, Strings& strings, pack::Contents& pack) {
  if (!cache.is_on()) return bake_geometry(scene, settings, progress, report, strings, pack);
  std::string entry;
  bool found = false;
  report.run("find_geometry", [&](PassReport&) {
    entry = geometry_entry(scene, settings);
    found = load_geometry(cache, entry, report, strings, pack);
  });
  if (found) return;
  const size_t first_pass = report.passes.size();
  bake_geometry(scene, settings, progress, report, strings, pack);
  report.run("keep_geometry", [&](PassReport&) { store_geometry(cache, entry, report, first_pass, pack); });
}

void bake_lights(const Scene& scene, const BakeSettings& settings, Report& report, Warnings& warnings, Strings& strings,
                 pack::Contents& pack) {
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
  report.run("light_audit", [&](PassReport& pass) { audit_lights(scene, pack, pass, warnings); });
}

}  // namespace

pack::Contents bake(Scene&& scene, const BakeSettings& settings, const Progress& progress, Report& report,
                    Warnings& warnings, Cache* cache) {
  Cache no_cache;
  Cache& kept = cache ? *cache : no_cache;
  pack::Contents pack;
  Strings strings(pack.strings);
  report.run("recentre", [&](PassReport& pass) { recentre(scene, pass, warnings); });
  std::vector<ImageRequest> requests;
  report.run("glass",
             [&](PassReport& pass) { find_glass(scene, settings.glass_shadows, settings.images, pass, warnings); });
  report.run("materials", [&](PassReport& pass) {
    requests = make_materials(scene, settings.images.textures != TextureMode::none, strings, pack);
    pass.bytes = bytes_of(pack.materials, pack.textures);
  });
  report.run("animation", [&](PassReport& pass) {
    make_animations(scene, strings, pack);
    pass.bytes = bytes_of(pack.nodes, pack.animations, pack.animation_channels, pack.animation_times,
                          pack.animation_values, pack.skins, pack.joints);
    pass.count("animations", static_cast<double>(pack.animations.size()));
  });
  find_or_bake_geometry(scene, settings, progress, report, kept, strings, pack);
  report.run("images", [&](PassReport& pass) {
    make_images(scene, requests, settings.images, progress, kept, pass, warnings, strings, pack);
    pass.bytes = bytes_of(pack.images, pack.image_data);
  });
  bake_lights(scene, settings, report, warnings, strings, pack);
  make_cameras(scene, strings, pack);
  describe(scene, settings, strings, pack);
  return pack;
}

void check(const pack::Contents& pack, Report& report) {
  report.run("check", [&](PassReport&) {
    const std::string fault = pack::check(pack::view_of(pack), most_threads());
    if (!fault.empty()) fail("scene", "cannot be stored in a pack: " + fault);
  });
}

}  // namespace chandelier::baker
