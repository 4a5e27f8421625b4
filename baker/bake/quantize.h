// SPDX-License-Identifier: Apache-2.0
// Pass: rounds vertices to grids, so that they compress well and nearly equal ones become equal, within a stated error.
#pragma once

#include "packed.h"

namespace chandelier::baker {

struct QuantizeSettings {
  float position_error_m = 0.0005f;  // in the world; 0 keeps floats
  int normal_bits = 10;
  int uv_bits = 14;  // after the point, of the image's coordinates; 0 keeps floats
};

/// The largest factor by which the upper left 3×3 matrix stretches a vector.
double largest_scale(const glm::dmat4& matrix);

/// The grid step of a mesh, a power of two; coordinates are rounded to its multiples; 0: they are not rounded. No
/// vertex moves by more than `error_m` where the mesh is stretched by at most `scale`, and `extent_ls`, the longest
/// side of its box, has at least 16384 steps.
double grid_step(double error_m, double scale, double extent_ls);

/// Takes the meshes' vertices out of the scene. Writes the measured errors to `info`: position_error_m,
/// normal_error_rad and uv_error. Attributes that no texture of the material needs become zero.
std::vector<PackedMesh> quantize(Scene& scene, const QuantizeSettings& settings, pack::BakeInfo& info);

}  // namespace chandelier::baker
