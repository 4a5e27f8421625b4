// SPDX-License-Identifier: Apache-2.0
#include "player/metrics/ssim.h"

#include "player/metrics/planes.h"

namespace chandelier::player {
namespace {

constexpr uint32_t radius = 5;
constexpr double sigma = 1.5;
constexpr double c1 = 0.01 * 0.01;  // (K L)² with a range L of 1
constexpr double c2 = 0.03 * 0.03;

Plane channel_of(const Picture& picture, size_t channel) {
  Plane plane{picture.width, picture.height, {}};
  for (size_t i = channel; i < picture.shown.size(); i += 4) plane.values.push_back(picture.shown[i] / 255.0);
  return plane;
}

// Weighted mean, around each pixel, of the product of two channels.
Plane mean_product(const Plane& a, const Plane& b, const Kernel& window) {
  Plane product = a;
  for (size_t i = 0; i < product.values.size(); ++i) product.values[i] *= b.values[i];
  return filtered(product, window, window);
}

// Wang et al. eq. 13, averaged as in eq. 14.
double mean_ssim(const Plane& a, const Plane& b) {
  const Kernel window = normalised(gaussian(radius, sigma));
  const Plane mean_a = filtered(a, window, window);
  const Plane mean_b = filtered(b, window, window);
  const Plane aa = mean_product(a, a, window);
  const Plane bb = mean_product(b, b, window);
  const Plane ab = mean_product(a, b, window);
  double sum = 0.0;
  for (size_t y = radius; y + radius < a.height; ++y) {
    for (size_t x = radius; x + radius < a.width; ++x) {
      const size_t i = y * a.width + x;
      const double ma = mean_a.values[i], mb = mean_b.values[i];
      const double variances = aa.values[i] - ma * ma + bb.values[i] - mb * mb;
      const double covariance = ab.values[i] - ma * mb;
      sum += (2.0 * ma * mb + c1) * (2.0 * covariance + c2) / ((ma * ma + mb * mb + c1) * (variances + c2));
    }
  }
  return sum / (static_cast<double>(a.width - 2 * radius) * (a.height - 2 * radius));
}

}  // namespace

std::optional<double> ssim(const Picture& a, const Picture& b) {
  if (a.width <= 2 * radius || a.height <= 2 * radius) return std::nullopt;
  double sum = 0.0;
  for (size_t channel = 0; channel < 3; ++channel) sum += mean_ssim(channel_of(a, channel), channel_of(b, channel));
  return sum / 3.0;
}

}  // namespace chandelier::player
