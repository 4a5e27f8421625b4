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

/// How one section is stored.
struct Stored {
  pack::Codec codec = pack::Codec::raw;
  uint64_t bytes = 0;  ///< In the file.
};

/// A BVH's nodes, and how many of them lie between a root and its farthest leaf, both counted.
struct Hierarchy {
  uint64_t nodes = 0, depth = 0;
};

struct Voxels {
  uint64_t occupied = 0;           ///< Cells that hold a triangle.
  uint64_t triangles = 0;          ///< In cells and in no-cull runs; clipped parts counted each.
  uint64_t no_cull_triangles = 0;  ///< Of those, the ones that no cell holds.
};

struct Summary {
  std::vector<Stored> stored;  ///< By section_infos.
  uint64_t stored_triangles = 0;
  uint64_t drawn_triangles = 0;
  uint64_t shadowless_triangles = 0;  ///< Of those, the ones that cast no shadow.
  uint64_t static_triangles = 0;      ///< Of those, the ones in instances that stand still.
  Spread batch_triangles;
  uint64_t masked_materials = 0;
  uint64_t double_sided_materials = 0;
  uint64_t shadowless_materials = 0, shadowless_instances = 0;
  std::array<uint64_t, 3> lights_of_type = {};    ///< By LightType.
  std::array<uint64_t, 3> lights_of_source = {};  ///< By RangeSource.
  uint64_t dynamic_lights = 0, unclustered_lights = 0;
  uint64_t grouped_lights = 0, light_groups = 0, shadowless_lights = 0;
  uint64_t closed_batches = 0;
  uint64_t dynamic_instances = 0, skinned_instances = 0;
  Hierarchy batch_bvh, instance_bvh, triangle_bvh, light_bvh;
  Voxels voxels;
  Spread range_m;                    ///< Of lights with an end.
  Spread intensity_cd;               ///< Of point and spot lights.
  std::vector<std::string> sources;  ///< The input files' names.
};

Summary summarize(const pack::File& file);

/// One report with sections, totals, images, cameras, and every light where `all_lights` says so.
std::string text_report(const std::string& path, const pack::File& file, bool all_lights);
/// The same and every light, as one JSON object.
std::string json_report(const std::string& path, const pack::File& file);

}  // namespace chandelier::inspect
