// SPDX-License-Identifier: Apache-2.0
// Pass: lights with a range, bounds and a voxel each, and cameras.
#pragma once

#include "../scene.h"
#include "pack_schema.h"
#include "strings.h"

namespace chandelier::baker {

/// Runs after the voxel pass, since each light records its cell.
void make_lights(const Scene& scene, float range_threshold_lx, Strings& strings, pack::Contents& pack);
void make_cameras(const Scene& scene, Strings& strings, pack::Contents& pack);

}  // namespace chandelier::baker
