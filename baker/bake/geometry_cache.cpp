// SPDX-License-Identifier: Apache-2.0
// The entry is a pack with the geometry's sections. Its materials hold only what the geometry depends on. Materials and
// everything else come from the scene that is baked.
#include "geometry_cache.h"

#include <nlohmann/json.hpp>

namespace chandelier::baker {
namespace {

using Json = nlohmann::json;

static_assert(pack::section_infos.size() == 37, "does bake_geometry() fill the new section? Then name it here");

template <typename Visit>
void for_each_geometry_section(pack::Contents& contents, const pack::View& view, Visit visit) {
  visit(contents.positions, view.positions);
  visit(contents.vertex_attributes, view.vertex_attributes);
  visit(contents.indices, view.indices);
  visit(contents.batches, view.batches);
  visit(contents.instances, view.instances);
  visit(contents.batch_instances, view.batch_instances);
  visit(contents.meshes, view.meshes);
  visit(contents.batch_bvh, view.batch_bvh);
  visit(contents.batch_bvh_items, view.batch_bvh_items);
  visit(contents.instance_bvh, view.instance_bvh);
  visit(contents.instance_bvh_items, view.instance_bvh_items);
  visit(contents.triangle_bvh, view.triangle_bvh);
  visit(contents.triangle_bvh_items, view.triangle_bvh_items);
  visit(contents.triangle_bvh_areas, view.triangle_bvh_areas);
  visit(contents.voxel_grid, view.voxel_grid);
  visit(contents.voxel_cells, view.voxel_cells);
  visit(contents.voxel_runs, view.voxel_runs);
  visit(contents.voxel_indices, view.voxel_indices);
  visit(contents.voxel_vertices, view.voxel_vertices);
  visit(contents.voxel_occupancy, view.voxel_occupancy);
  visit(contents.skin_vertices, view.skin_vertices);
}

std::string notes_of(const std::vector<PassReport>& passes, size_t first) {
  Json out = Json::array();
  for (size_t i = first; i < passes.size(); ++i) {
    out.push_back({{"name", passes[i].name}, {"bytes", passes[i].bytes}, {"counts", passes[i].counts}});
  }
  return Json{{"passes", out}}.dump();
}

std::vector<PassReport> passes_of(const std::string& notes) {
  std::vector<PassReport> out;
  const Json all = Json::parse(notes);
  for (const Json& in : all.at("passes")) {
    PassReport& pass = out.emplace_back();
    pass.name = in.at("name").get<std::string>();
    pass.bytes = in.at("bytes").get<uint64_t>();
    pass.counts = in.at("counts").get<decltype(pass.counts)>();
    pass.cached = true;
  }
  return out;
}

/// An entry fits where its materials and nodes are as many as the scene's.
std::string fault_of(const CacheEntry& entry, const pack::Contents& pack) {
  const pack::View& view = entry.pack.view();
  if (view.materials.size() != pack.materials.size()) return "has other materials";
  if (view.nodes.size() != pack.nodes.size() || view.skins.size() != pack.skins.size()) return "has other nodes";
  return {};
}

}  // namespace

bool load_geometry(Cache& cache, const std::string& name, Report& report, Strings& strings, pack::Contents& pack) {
  const std::unique_ptr<CacheEntry> entry = cache.load(name);
  if (!entry) return false;
  std::string fault = fault_of(*entry, pack);
  std::vector<PassReport> passes;
  try {
    passes = passes_of(entry->notes);
  } catch (const Json::exception&) {
    fault = "has damaged notes";
  }
  if (!fault.empty()) {
    cache.reject(name, fault);
    return false;
  }
  const auto copy = [](auto& to, const auto& from) { to.assign(from.begin(), from.end()); };
  for_each_geometry_section(pack, entry->pack.view(), copy);
  pack.bake_info = *entry->pack.view().bake_info;
  pack.bake_info.source = {};
  for (pack::Instance& instance : pack.instances) {
    instance.name = strings.add(std::string(entry->pack.text(instance.name)));
  }
  report.passes.insert(report.passes.end(), passes.begin(), passes.end());
  return true;
}

void store_geometry(Cache& cache, const std::string& name, const Report& report, size_t first_pass,
                    const pack::Contents& pack) {
  std::vector<pack::Material> materials = pack.materials;
  for (pack::Material& material : materials) {
    for (uint32_t* texture : {&material.base_color_texture, &material.metallic_roughness_texture,
                              &material.normal_texture, &material.occlusion_texture, &material.emissive_texture}) {
      *texture = pack::none;
    }
  }
  pack::View view = pack::view_of(pack);
  view.materials = materials;
  view.textures = {};
  view.animations = {};
  view.animation_channels = {};
  view.animation_times = {};
  view.animation_values = {};
  cache.store(name, view, notes_of(report.passes, first_pass));
}

}  // namespace chandelier::baker
