// SPDX-License-Identifier: Apache-2.0
// chandelier-inspect's report for machines.
#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "summary.h"

namespace chandelier::inspect {
namespace {

using Json = nlohmann::ordered_json;

Json to_json(const glm::dvec3& v) {
  return Json::array({v.x, v.y, v.z});
}

Json to_json(const Spread& s) {
  return {{"min", s.min}, {"mean", s.mean}, {"max", s.max}};
}

std::string name(const pack::File& file, const pack::StringRef& ref) {
  return std::string(file.text(ref));
}

Json sections(const pack::View& view, const Summary& summary) {
  Json list = Json::array();
  for (size_t i = 0; i < pack::section_infos.size(); ++i) {
    const pack::SectionInfo& info = pack::section_infos[i];
    const size_t bytes = pack::section_bytes(view, i).size();
    list.push_back({{"kind", static_cast<uint32_t>(info.kind)},
                    {"name", info.name},
                    {"count", bytes / info.stride_bytes},
                    {"stride_bytes", info.stride_bytes},
                    {"size_bytes", bytes},
                    {"stored_bytes", summary.stored[i].bytes},
                    {"codec", name_of(summary.stored[i].codec)}});
  }
  return list;
}

Json to_json(const Hierarchy& bvh) {
  return {{"nodes", bvh.nodes}, {"depth", bvh.depth}};
}

Json voxels(const pack::View& view, const Summary& summary) {
  if (view.voxel_grid.empty()) return nullptr;
  const pack::VoxelGrid& grid = view.voxel_grid[0];
  return {{"resolution", grid.resolution},
          {"mode", name_of(grid.mode)},
          {"occupied", summary.voxels.occupied},
          {"triangles", summary.voxels.triangles},
          {"no_cull_triangles", summary.voxels.no_cull_triangles}};
}

Json animations(const pack::File& file) {
  Json list = Json::array();
  for (const pack::Animation& animation : file.view().animations) {
    list.push_back({{"name", name(file, animation.name)},
                    {"duration_s", animation.duration_s},
                    {"channels", animation.channel_count}});
  }
  return list;
}

Json materials(const pack::File& file) {
  Json list = Json::array();
  for (const pack::Material& material : file.view().materials) {
    list.push_back({{"name", name(file, material.name)},
                    {"alpha_mode", name_of(material.alpha_mode)},
                    {"double_sided", material.double_sided == 1},
                    {"shadowless", material.shadowless == 1},
                    {"transmission_factor", material.transmission_factor}});
  }
  return list;
}

Json images(const pack::File& file) {
  Json list = Json::array();
  for (const pack::Image& image : file.view().images) {
    list.push_back({{"name", name(file, image.name)},
                    {"width", image.width},
                    {"height", image.height},
                    {"level_count", image.level_count},
                    {"format", name_of(image.format)},
                    {"size_bytes", image.size_bytes},
                    {"stored_bytes", image.stored_bytes},
                    {"codec", name_of(image.codec)}});
  }
  return list;
}

Json lights(const pack::File& file) {
  Json list = Json::array();
  for (const pack::Light& light : file.view().lights) {
    list.push_back({{"name", name(file, light.name)},
                    {"type", name_of(light.type)},
                    {"position_ws", to_json(light.position_ws)},
                    {"direction_ws", to_json(light.direction_ws)},
                    {"color", to_json(light.color)},
                    {"intensity", light.intensity},
                    {"range_m", light.range_m},
                    {"range_source", name_of(light.range_source)},
                    {"nearest_caster_m", light.nearest_caster_m},
                    {"inner_cone_cos", light.inner_cone_cos},
                    {"outer_cone_cos", light.outer_cone_cos},
                    {"bounds_center_ws", to_json(light.bounds_center_ws)},
                    {"bounds_radius_m", light.bounds_radius_m},
                    {"priority", light.priority},
                    {"dynamic", light.dynamic == 1},
                    {"unclustered", light.unclustered == 1},
                    {"shadowless", light.shadowless == 1},
                    {"radius_m", light.radius_m},
                    {"group", light.group}});
  }
  return list;
}

Json cameras(const pack::File& file) {
  Json list = Json::array();
  for (const pack::Camera& camera : file.view().cameras) {
    list.push_back({{"name", name(file, camera.name)},
                    {"position_ws", to_json(camera.position_ws)},
                    {"forward_ws", to_json(camera.forward_ws)},
                    {"up_ws", to_json(camera.up_ws)},
                    {"yfov_rad", camera.yfov_rad},
                    {"aspect", camera.aspect},
                    {"znear_m", camera.znear_m}});
  }
  return list;
}

}  // namespace

std::string json_report(const std::string& path, const pack::File& file) {
  const Summary summary = summarize(file);
  const pack::View& view = file.view();
  const Json report = {{"file", path},
                       {"size_bytes", file.size_bytes()},
                       {"version", pack::schema_version},
                       {"schema_hash", fmt::format("{:016x}", pack::schema_hash)},
                       {"sources", summary.sources},
                       {"bounds_min_ws", to_json(view.bake_info->bounds_min_ws)},
                       {"bounds_max_ws", to_json(view.bake_info->bounds_max_ws)},
                       {"origin_m", to_json(view.bake_info->origin_m)},
                       {"range_threshold_lx", view.bake_info->range_threshold_lx},
                       {"position_error_m", view.bake_info->position_error_m},
                       {"normal_error_rad", view.bake_info->normal_error_rad},
                       {"uv_error", view.bake_info->uv_error},
                       {"sections", sections(view, summary)},
                       {"triangles",
                        {{"stored", summary.stored_triangles},
                         {"drawn", summary.drawn_triangles},
                         {"shadowless", summary.shadowless_triangles}}},
                       {"batches",
                        {{"count", view.batches.size()},
                         {"drawn", view.batch_instances.size()},
                         {"closed", summary.closed_batches},
                         {"triangles", to_json(summary.batch_triangles)}}},
                       {"instances", view.instances.size()},
                       {"dynamic_instances", summary.dynamic_instances},
                       {"skinned_instances", summary.skinned_instances},
                       {"shadowless_instances", summary.shadowless_instances},
                       {"batch_bvh", to_json(summary.batch_bvh)},
                       {"instance_bvh", to_json(summary.instance_bvh)},
                       {"triangle_bvh", to_json(summary.triangle_bvh)},
                       {"light_bvh", to_json(summary.light_bvh)},
                       {"voxels", voxels(view, summary)},
                       {"nodes", view.nodes.size()},
                       {"animations", animations(file)},
                       {"skins", view.skins.size()},
                       {"materials", materials(file)},
                       {"images", images(file)},
                       {"lights", lights(file)},
                       {"cameras", cameras(file)}};
  // Strings are as the input had them; what is not UTF-8 becomes the replacement character.
  return report.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace chandelier::inspect
