// SPDX-License-Identifier: Apache-2.0
// What both reports of chandelier-inspect say about a pack.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "pack_file.h"

namespace chandelier::inspect {

/// Smallest, largest and mean; all zero where there is nothing.
struct Spread {
  double min = 0, mean = 0, max = 0;
};

struct Summary {
  std::uint64_t stored_triangles = 0;
  std::uint64_t drawn_triangles = 0;
  Spread batch_triangles;
  std::uint64_t masked_materials = 0;
  std::uint64_t double_sided_materials = 0;
  std::array<std::uint64_t, 3> lights_of_type = {};    ///< By LightType.
  std::array<std::uint64_t, 3> lights_of_source = {};  ///< By RangeSource.
  Spread range_m;                                      ///< Of lights with an end.
  Spread intensity_cd;                                 ///< Of point and spot lights.
  std::vector<std::string> sources;                    ///< The input files' names.
};

Summary summarize(const pack::File& file);

/// One report with sections, totals, images, cameras, and every light where `all_lights` says so.
std::string text_report(const std::string& path, const pack::File& file, bool all_lights);
/// The same and every light, as one JSON object.
std::string json_report(const std::string& path, const pack::File& file);

}  // namespace chandelier::inspect
