// SPDX-License-Identifier: Apache-2.0
// chandelier-inspect's report for people.
#include <fmt/format.h>

#include <cmath>
#include <iterator>

#include "summary.h"

namespace chandelier::inspect {
namespace {

using Out = std::back_insert_iterator<std::string>;

/// Names come from files that anybody may have written: keeps control characters off the terminal.
std::string printable(std::string_view text) {
  std::string out;
  for (const char c : text) {
    const unsigned char byte = static_cast<unsigned char>(c);
    if (byte < 0x20 || byte == 0x7f) {
      fmt::format_to(std::back_inserter(out), "\\x{:02x}", byte);
    } else {
      out += c;
    }
  }
  return out;
}

std::string size_text(uint64_t bytes) {
  if (bytes < 1024) return fmt::format("{} bytes", bytes);
  static constexpr const char* units[] = {"KiB", "MiB", "GiB", "TiB"};
  double value = static_cast<double>(bytes) / 1024;
  size_t unit = 0;
  for (; value >= 1024 && unit < 3; ++unit) value /= 1024;
  return fmt::format("{:.1f} {}", value, units[unit]);
}

std::string vector_text(const glm::vec3& v) {
  return fmt::format("{:.3g}, {:.3g}, {:.3g}", v.x, v.y, v.z);
}

/// In the coordinates of the glTF; far from their origin to the centimetre.
std::string place_text(const glm::vec3& p_ws, const pack::BakeInfo& info) {
  if (info.origin_m == glm::dvec3(0)) return vector_text(p_ws);
  const glm::dvec3 p = info.origin_m + glm::dvec3(p_ws);
  return fmt::format("{:.2f}, {:.2f}, {:.2f}", p.x, p.y, p.z);
}

void put_sections(Out out, const pack::View& view, const Summary& summary) {
  fmt::format_to(out, "\n{:<20}{:>12}{:>8}{:>16}{:>16}  {}\n", "section", "count", "stride", "bytes", "stored",
                 "codec");
  for (size_t i = 0; i < pack::section_infos.size(); ++i) {
    const pack::SectionInfo& info = pack::section_infos[i];
    const size_t bytes = pack::section_bytes(view, i).size();
    if (bytes == 0) continue;
    fmt::format_to(out, "{:<20}{:>12}{:>8}{:>16}{:>16}  {}\n", info.name, bytes / info.stride_bytes, info.stride_bytes,
                   bytes, summary.stored[i].bytes, name_of(summary.stored[i].codec));
  }
}

/// A share as "37.5 %".
std::string share(uint64_t part, uint64_t whole) {
  return fmt::format("{:.1f} %", whole == 0 ? 0.0 : 100.0 * static_cast<double>(part) / static_cast<double>(whole));
}

void put_geometry(Out out, const pack::View& view, const Summary& summary) {
  const Spread& size = summary.batch_triangles;
  fmt::format_to(out, "\ntriangles  {} stored, {} drawn by {} instances\n", summary.stored_triangles,
                 summary.drawn_triangles, view.instances.size());
  fmt::format_to(out, "batches    {} of {:.0f} to {:.0f} triangles, {:.1f} in the mean; {} drawn; {} ({}) closed\n",
                 view.batches.size(), size.min, size.max, size.mean, view.batch_instances.size(),
                 summary.closed_batches, share(summary.closed_batches, view.batches.size()));
  fmt::format_to(out, "materials  {}, {} with an alpha mask, {} double-sided\n", view.materials.size(),
                 summary.masked_materials, summary.double_sided_materials);
  if (summary.shadowless_triangles > 0) {
    fmt::format_to(out, "no shadow  {} of the drawn triangles ({}): of {} materials and {} instances\n",
                   summary.shadowless_triangles, share(summary.shadowless_triangles, summary.drawn_triangles),
                   summary.shadowless_materials, summary.shadowless_instances);
  }
}

void put_structures(Out out, const pack::View& view, const Summary& summary) {
  const auto put_bvh = [&](const char* name, const Hierarchy& bvh, const char* more) {
    if (bvh.nodes > 0) fmt::format_to(out, "{:<13}{} nodes, {} deep{}\n", name, bvh.nodes, bvh.depth, more);
  };
  put_bvh("batch BVH", summary.batch_bvh, "");
  put_bvh("instance BVH", summary.instance_bvh, "");
  put_bvh("triangle BVH", summary.triangle_bvh, " at most, one for each mesh");
  put_bvh("light BVH", summary.light_bvh, "");
  for (const pack::VoxelGrid& grid : view.voxel_grid) {
    fmt::format_to(out, "voxels     {} x {} x {}, {}; {} ({}) occupied; {} of {} static triangles ({}) always drawn\n",
                   grid.resolution[0], grid.resolution[1], grid.resolution[2], name_of(grid.mode),
                   summary.voxels.occupied, share(summary.voxels.occupied, view.voxel_cells.size()),
                   summary.voxels.no_cull_triangles, summary.static_triangles,
                   share(summary.voxels.no_cull_triangles, summary.static_triangles));
  }
  if (!view.nodes.empty()) {
    fmt::format_to(out, "motion     {} nodes, {} animations, {} skins; {} of {} instances move, {} by a skin\n",
                   view.nodes.size(), view.animations.size(), view.skins.size(), summary.dynamic_instances,
                   view.instances.size(), summary.skinned_instances);
  }
}

/// Each animation with its length.
void put_animations(Out out, const pack::File& file) {
  for (const pack::Animation& animation : file.view().animations) {
    const std::string name = printable(file.text(animation.name));
    fmt::format_to(out, "  {:>8.3g} s, {} channel{}{}{}\n", animation.duration_s, animation.channel_count,
                   animation.channel_count == 1 ? "" : "s", name.empty() ? "" : "  ", name);
  }
}

void put_images(Out out, const pack::File& file) {
  const pack::View& view = file.view();
  uint64_t bytes = 0;
  for (const pack::Image& image : view.images) bytes += image.size_bytes;
  fmt::format_to(out, "images     {}, {}, stored as {}\n", view.images.size(), size_text(bytes),
                 size_text(view.image_data.size()));
  for (const pack::Image& image : view.images) {
    fmt::format_to(out, "  {:>5} x {:<5} {:>2} levels  {:<13}  {:>10}  {:<4}  {:>10}  {}\n", image.width, image.height,
                   image.level_count, name_of(image.format), size_text(image.size_bytes), name_of(image.codec),
                   size_text(image.stored_bytes), printable(file.text(image.name)));
  }
}

void put_light_table(Out out, const pack::File& file) {
  fmt::format_to(out, "  {:<12}{:<30}{:>12}    {:<20}{}\n", "type", "position, m", "intensity", "range", "name");
  for (const pack::Light& light : file.view().lights) {
    const bool directional = light.type == pack::LightType::directional;
    const std::string place =
        directional ? "to " + vector_text(light.direction_ws) : place_text(light.position_ws, *file.view().bake_info);
    const std::string range = light.range_source == pack::RangeSource::unbounded
                                  ? "no end"
                                  : fmt::format("{:.4g} m {}", light.range_m, name_of(light.range_source));
    fmt::format_to(out, "  {:<12}{:<30}{:>9.4g} {}    {:<20}{}\n", name_of(light.type), place, light.intensity,
                   directional ? "lx" : "cd", range, printable(file.text(light.name)));
  }
}

void put_lights(Out out, const pack::File& file, const Summary& summary, bool all_lights) {
  fmt::format_to(
      out,
      "lights     {}: {} point, {} spot, {} directional; {} dynamic, {} unclustered, {} without shadow, {} in "
      "{} groups\n",
      file.view().lights.size(), summary.lights_of_type[0], summary.lights_of_type[1], summary.lights_of_type[2],
      summary.dynamic_lights, summary.unclustered_lights, summary.shadowless_lights, summary.grouped_lights,
      summary.light_groups);
  if (summary.lights_of_type[0] + summary.lights_of_type[1] > 0) {
    fmt::format_to(out, "  range      {:.4g} to {:.4g} m; {} authored, {} derived at {:.3g} lx\n", summary.range_m.min,
                   summary.range_m.max, summary.lights_of_source[0], summary.lights_of_source[1],
                   file.view().bake_info->range_threshold_lx);
    fmt::format_to(out, "  intensity  {:.4g} to {:.4g} cd\n", summary.intensity_cd.min, summary.intensity_cd.max);
  }
  if (all_lights && !file.view().lights.empty()) put_light_table(out, file);
}

void put_cameras(Out out, const pack::File& file) {
  fmt::format_to(out, "cameras    {}\n", file.view().cameras.size());
  for (const pack::Camera& camera : file.view().cameras) {
    fmt::format_to(out, "  {}  at {} towards {}, {:.1f} degrees high\n", printable(file.text(camera.name)),
                   place_text(camera.position_ws, *file.view().bake_info), vector_text(camera.forward_ws),
                   camera.yfov_rad * 180.0 / std::acos(-1.0));
  }
}

}  // namespace

std::string text_report(const std::string& path, const pack::File& file, bool all_lights) {
  const Summary summary = summarize(file);
  const pack::BakeInfo& info = *file.view().bake_info;
  std::string text;
  const Out out = std::back_inserter(text);
  fmt::format_to(out, "{}: {}, version {}\n", printable(path), size_text(file.size_bytes()), pack::schema_version);
  for (const std::string& source : summary.sources) fmt::format_to(out, "  from {}\n", printable(source));
  fmt::format_to(out, "  bounds ({}) to ({}) m\n", place_text(info.bounds_min_ws, info),
                 place_text(info.bounds_max_ws, info));
  if (info.origin_m != glm::dvec3(0)) {
    fmt::format_to(out, "  stored from an origin at ({:.0f}, {:.0f}, {:.0f}) m; places here are the glTF's\n",
                   info.origin_m.x, info.origin_m.y, info.origin_m.z);
  }
  put_sections(out, file.view(), summary);
  put_geometry(out, file.view(), summary);
  put_structures(out, file.view(), summary);
  put_animations(out, file);
  put_images(out, file);
  put_lights(out, file, summary, all_lights);
  put_cameras(out, file);
  return text;
}

}  // namespace chandelier::inspect
