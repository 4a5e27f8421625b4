// SPDX-License-Identifier: Apache-2.0
// What both reports of chandelier-inspect say about a pack.
#include "summary.h"

#include <algorithm>

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
  std::uint64_t count_ = 0;
};

void add_lights(const pack::View& view, Summary& summary) {
  Gather ranges, intensities;
  for (const pack::Light& light : view.lights) {
    ++summary.lights_of_type[static_cast<std::size_t>(light.type)];
    ++summary.lights_of_source[static_cast<std::size_t>(light.range_source)];
    if (light.range_source != pack::RangeSource::unbounded) ranges.add(light.range_m);
    if (light.type != pack::LightType::directional) intensities.add(light.intensity);
  }
  summary.range_m = ranges.spread();
  summary.intensity_cd = intensities.spread();
}

std::vector<std::string> split_lines(std::string_view text) {
  std::vector<std::string> lines;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find('\n'), text.size());
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
  for (const pack::Batch& batch : view.batches) triangles.add(batch.index_count / 3);
  summary.batch_triangles = triangles.spread();
  for (const pack::BatchInstance& draw : view.batch_instances) {
    summary.drawn_triangles += view.batches[draw.batch].index_count / 3;
  }
  for (const pack::Material& material : view.materials) {
    summary.masked_materials += material.alpha_mode == pack::AlphaMode::mask;
    summary.double_sided_materials += material.double_sided;
  }
  add_lights(view, summary);
  summary.sources = split_lines(file.text(view.bake_info->source));
  return summary;
}

}  // namespace chandelier::inspect
