// SPDX-License-Identifier: Apache-2.0
// What both reports of chandelier-inspect say about a pack.
#include "summary.h"

#include <algorithm>

#include "throws_shadow.h"

namespace chandelier::inspect {
namespace {

/// Gathers a Spread value by value.
class Gather {
 public:
  void add(double value) {
    spread_.min = count_ == 0 ? value : std::min(spread_.min, value);
    spread_.max = count_ == 0 ? value : std::max(spread_.max, value);
    sum_ += value;
    ++count_;
  }
  Spread spread() const { return {spread_.min, count_ == 0 ? 0.0 : sum_ / static_cast<double>(count_), spread_.max}; }

 private:
  Spread spread_;
  double sum_ = 0;
  uint64_t count_ = 0;
};

void add_lights(const pack::View& view, Summary& summary) {
  Gather ranges, intensities;
  for (const pack::Light& light : view.lights) {
    ++summary.lights_of_type[static_cast<size_t>(light.type)];
    ++summary.lights_of_source[static_cast<size_t>(light.range_source)];
    summary.dynamic_lights += light.dynamic;
    summary.unclustered_lights += light.unclustered;
    summary.shadowless_lights += light.shadowless;
    summary.grouped_lights += light.group != 0;
    summary.light_groups = std::max<uint64_t>(summary.light_groups, light.group);  // numbered from 1
    if (light.range_source != pack::RangeSource::unbounded) ranges.add(light.range_m);
    if (light.type != pack::LightType::directional) intensities.add(light.intensity);
  }
  summary.range_m = ranges.spread();
  summary.intensity_cd = intensities.spread();
}

/// Of nodes in depth-first order; `end_of` gives the number of the node after a node's subtree.
template <typename Node, typename End>
Hierarchy hierarchy(std::span<const Node> nodes, End end_of) {
  Hierarchy result{nodes.size(), 0};
  std::vector<uint64_t> ends;  // of the subtrees around the node, outermost first
  for (size_t i = 0; i < nodes.size(); ++i) {
    while (!ends.empty() && ends.back() <= i) ends.pop_back();
    ends.push_back(end_of(nodes[i]));
    result.depth = std::max<uint64_t>(result.depth, ends.size());
  }
  return result;
}

void add_hierarchies(const pack::View& view, Summary& summary) {
  const auto skip = [](const pack::BvhNode& node) { return node.skip; };
  summary.batch_bvh = hierarchy(view.batch_bvh, skip);
  summary.instance_bvh = hierarchy(view.instance_bvh, skip);
  summary.light_bvh = hierarchy(view.light_bvh, [](const pack::LightBvhNode& node) { return node.miss; });
  summary.triangle_bvh = hierarchy(view.triangle_bvh, skip);
}

void add_voxels(const pack::View& view, Summary& summary) {
  for (const pack::VoxelCell& cell : view.voxel_cells) summary.voxels.occupied += cell.run_count > 0;
  summary.voxels.triangles = view.voxel_indices.size() / 3;
  for (const pack::VoxelGrid& grid : view.voxel_grid) {
    for (const pack::VoxelRun& run : view.voxel_runs.subspan(grid.no_cull_first_run, grid.no_cull_run_count)) {
      summary.voxels.no_cull_triangles += run.index_count / 3;
    }
  }
}

std::vector<Stored> stored_sections(const pack::File& file) {
  std::vector<Stored> stored(pack::section_infos.size());
  for (const pack::SectionEntry& entry : file.table()) {
    for (size_t i = 0; i < stored.size(); ++i) {
      if (static_cast<uint32_t>(pack::section_infos[i].kind) == entry.kind) {
        stored[i] = {entry.codec, entry.size_bytes};
      }
    }
  }
  return stored;
}

std::vector<std::string> split_lines(std::string_view text) {
  std::vector<std::string> lines;
  while (!text.empty()) {
    const size_t end = std::min(text.find('\n'), text.size());
    lines.emplace_back(text.substr(0, end));
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return lines;
}

}  // namespace

Summary summarize(const pack::File& file) {
  const pack::View& view = file.view();
  Summary summary;
  summary.stored_triangles = view.indices.size() / 3;
  Gather triangles;
  for (const pack::Batch& batch : view.batches) {
    triangles.add(batch.index_count / 3);
    summary.closed_batches += batch.closed;
  }
  summary.batch_triangles = triangles.spread();
  for (const pack::BatchInstance& draw : view.batch_instances) {
    const uint64_t drawn = view.batches[draw.batch].index_count / 3;
    summary.drawn_triangles += drawn;
    if (view.instances[draw.instance].dynamic == 0) summary.static_triangles += drawn;
    if (!pack::throws_shadow(view, draw)) summary.shadowless_triangles += drawn;
  }
  for (const pack::Material& material : view.materials) {
    summary.masked_materials += material.alpha_mode == pack::AlphaMode::mask;
    summary.double_sided_materials += material.double_sided;
    summary.shadowless_materials += material.shadowless;
  }
  for (const pack::Instance& instance : view.instances) {
    summary.dynamic_instances += instance.dynamic;
    summary.shadowless_instances += instance.shadowless;
    summary.skinned_instances += instance.skin != pack::none;
  }
  add_lights(view, summary);
  add_hierarchies(view, summary);
  add_voxels(view, summary);
  summary.stored = stored_sections(file);
  summary.sources = split_lines(file.text(view.bake_info->source));
  return summary;
}

}  // namespace chandelier::inspect
