// SPDX-License-Identifier: Apache-2.0
// The bake: scene in, pack out.
#pragma once

#include <cstdint>

#include "../cache.h"
#include "../error.h"
#include "../progress.h"
#include "../report.h"
#include "../scene.h"
#include "images.h"
#include "light_range.h"
#include "pack_schema.h"
#include "voxel_bins.h"

namespace chandelier::baker {

struct BakeSettings {
  uint32_t batch_triangles = 100;                               // largest number per batch; a multiple of 4, up to 512
  float range_threshold_lx = pack::default_range_threshold_lx;  // where a light without a range of its own ends
  float position_error_m = 0.0005f;  // largest distance that a vertex may move in the world; 0 keeps floats
  int normal_bits = 10;              // of each of a normal's and a tangent's two numbers, 8 to 16
  int uv_bits = 14;                  // of a texture coordinate after the point, up to 20; 0 keeps floats
  VoxelSettings voxels;
  ImageSettings images;
  float smooth_angle_deg = 0;  // missing normals: neighbours within this are smoothed; 0: all flat
  bool glass_shadows = false;  // glass casts shadows too
};

/// Runs all passes and records each in `report`. Uses `cache`, if there is one. The same scene and settings give the
/// same contents, whatever the number of threads. Call check() on them afterwards. Throws Error.
pack::Contents bake(Scene&& scene, const BakeSettings& settings, const Progress& progress, Report& report,
                    Warnings& warnings, Cache* cache = nullptr);

/// Throws Error unless a pack with these contents will open.
void check(const pack::Contents& pack, Report& report);

}  // namespace chandelier::baker
