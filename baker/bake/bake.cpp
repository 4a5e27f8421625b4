// SPDX-License-Identifier: Apache-2.0
// The passes in their order.
#include "bake.h"

#include "../error.h"
#include "batches.h"
#include "images.h"
#include "instances.h"
#include "lights.h"
#include "pack_checks.h"
#include "strings.h"
#include "textures.h"

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

}  // namespace

pack::Contents bake(Scene&& scene, const BakeSettings& settings, const Progress& progress) {
  pack::Contents pack;
  Strings strings(pack.strings);
  const std::vector<MeshBatches> meshes = make_batches(scene, settings.batch_triangles, progress, pack);
  const std::vector<ImageRequest> requests = make_materials(scene, strings, pack);
  make_instances(scene, meshes, strings, pack);
  make_images(scene, requests, progress, strings, pack);
  make_lights(scene, settings.range_threshold_lx, strings, pack);
  make_cameras(scene, strings, pack);
  describe(scene, settings, strings, pack);
  const std::string fault = pack::check(pack::view_of(pack));
  if (!fault.empty()) fail("scene", "cannot be stored in a pack: " + fault);
  return pack;
}

}  // namespace chandelier::baker
