// SPDX-License-Identifier: Apache-2.0
#include "player/metrics/planes.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "parallel.h"

namespace chandelier::player {
namespace {

void filter_row(const Kernel& kernel, const double* from, size_t count, double* to) {
  const size_t radius = kernel.size() / 2;
  std::vector<double> line(count + 2 * radius);
  for (size_t i = 0; i < line.size(); ++i) line[i] = from[std::clamp(i, radius, radius + count - 1) - radius];
  std::fill_n(to, count, 0.0);
  for (size_t k = 0; k < kernel.size(); ++k)
    for (size_t i = 0; i < count; ++i) to[i] += kernel[k] * line[i + k];
}

}  // namespace

Kernel gaussian(int radius, double sigma_px) {
  Kernel kernel;
  for (int x = -radius; x <= radius; ++x) kernel.push_back(std::exp(-x * x / (2.0 * sigma_px * sigma_px)));
  return kernel;
}

Kernel normalised(Kernel kernel) {
  const double sum = std::accumulate(kernel.begin(), kernel.end(), 0.0);
  for (double& weight : kernel) weight /= sum;
  return kernel;
}

Plane filtered(const Plane& plane, const Kernel& along_x, const Kernel& along_y) {
  const size_t width = plane.width, height = plane.height;
  Plane rows = plane;
  pack::parallel_for(height, 0,
                     [&](size_t y) { filter_row(along_x, &plane.values[y * width], width, &rows.values[y * width]); });
  Plane result = plane;
  const auto radius = static_cast<ptrdiff_t>(along_y.size() / 2);
  const auto last = static_cast<ptrdiff_t>(height) - 1;
  pack::parallel_for(height, 0, [&](size_t y) {
    double* const to = &result.values[y * width];
    std::fill_n(to, width, 0.0);
    for (ptrdiff_t k = -radius; k <= radius; ++k) {
      const auto row = static_cast<size_t>(std::clamp(static_cast<ptrdiff_t>(y) + k, ptrdiff_t{0}, last));
      const double weight = along_y[static_cast<size_t>(k + radius)];
      for (size_t x = 0; x < width; ++x) to[x] += weight * rows.values[row * width + x];
    }
  });
  return result;
}

}  // namespace chandelier::player
