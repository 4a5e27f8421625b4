// SPDX-License-Identifier: Apache-2.0
// One channel of a picture, and filters over it: what the metrics are made of.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace chandelier::player {

/// Rows from the top.
struct Plane {
  uint32_t width = 0;
  uint32_t height = 0;
  std::vector<double> values;
};

/// An odd number of weights; the middle one is the pixel's own.
using Kernel = std::vector<double>;

/// exp(-x² / (2 sigma²)) at x = -radius … radius pixels, not normalised.
Kernel gaussian(int radius, double sigma_px);
/// Divides the weights by their sum.
Kernel normalised(Kernel kernel);

/// Filters rows by `along_x`, then columns by `along_y`. Beyond an edge its own pixels go on.
Plane filtered(const Plane& plane, const Kernel& along_x, const Kernel& along_y);

}  // namespace chandelier::player
