// SPDX-License-Identifier: Apache-2.0
// Symbols and the names of steps are the paper's.
#include "player/metrics/flip.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/glm.hpp>
#include <span>

#include "player/metrics/planes.h"

namespace chandelier::player {
namespace {

using std::numbers::pi;

constexpr double color_exponent = 0.7;       // q_c
constexpr double color_knee = 0.4;           // p_c, of the largest colour difference
constexpr double color_at_knee = 0.95;       // p_t
constexpr double feature_width_deg = 0.082;  // w
constexpr double feature_exponent = 0.5;     // q_f

// Y, Cx and Cz, or L*, a* and b*.
using Channels = std::array<Plane, 3>;

// Linear sRGB to XYZ: columns are the primaries of IEC 61966-2-1, so strong that together they give the white D65.
glm::dmat3 xyz_from_rgb() {
  const auto xyz = [](double x, double y) { return glm::dvec3(x / y, 1.0, (1.0 - x - y) / y); };
  const glm::dmat3 primaries(xyz(0.64, 0.33), xyz(0.30, 0.60), xyz(0.15, 0.06));
  const glm::dvec3 amounts = glm::inverse(primaries) * xyz(0.31271, 0.32902);
  return {primaries[0] * amounts.x, primaries[1] * amounts.y, primaries[2] * amounts.z};
}

struct ColorSpaces {
  glm::dmat3 xyz_from_rgb = player::xyz_from_rgb();
  glm::dmat3 rgb_from_xyz = glm::inverse(xyz_from_rgb);
  glm::dvec3 white = xyz_from_rgb * glm::dvec3(1.0);
};

// IEC 61966-2-1
double linear(uint8_t shown) {
  const double s = shown / 255.0;
  return s <= 0.04045 ? s / 12.92 : std::pow((s + 0.055) / 1.055, 2.4);
}

// A linear opponent space, so that filtering shifts no hue.
glm::dvec3 ycxcz(const ColorSpaces& spaces, const glm::dvec3& rgb) {
  const glm::dvec3 t = spaces.xyz_from_rgb * rgb / spaces.white;
  return {116.0 * t.y - 16.0, 500.0 * (t.x - t.y), 200.0 * (t.y - t.z)};
}
glm::dvec3 rgb_of_ycxcz(const ColorSpaces& spaces, const glm::dvec3& c) {
  const double y = (c.x + 16.0) / 116.0;
  return spaces.rgb_from_xyz * (glm::dvec3(y + c.y / 500.0, y, y - c.z / 200.0) * spaces.white);
}

// CIE 1976 L*a*b*, chroma scaled by lightness (Hunt adjustment).
glm::dvec3 hunt_lab(const ColorSpaces& spaces, const glm::dvec3& rgb) {
  constexpr double delta = 6.0 / 29.0;
  const auto f = [](double t) {
    return t > delta * delta * delta ? std::cbrt(t) : t / (3.0 * delta * delta) + 4.0 / 29.0;
  };
  const glm::dvec3 t = spaces.xyz_from_rgb * rgb / spaces.white;
  const double lightness = 116.0 * f(t.y) - 16.0;
  return {lightness, 0.01 * lightness * 500.0 * (f(t.x) - f(t.y)), 0.01 * lightness * 200.0 * (f(t.y) - f(t.z))};
}

// HyAB: city blocks in lightness, straight in chroma.
double hyab(const glm::dvec3& a, const glm::dvec3& b) {
  const glm::dvec3 d = a - b;
  return std::abs(d.x) + std::hypot(d.y, d.z);
}

// Contrast sensitivity functions: what the eye resolves of each channel, as Gaussians of the angle.
struct Sensitivity {
  double amplitude;  // a of a sqrt(π / b) exp(-π² x² / b), x in degrees
  double b;
};
constexpr std::array<Sensitivity, 1> luminance_sensitivity{{{1.0, 0.0047}}};
constexpr std::array<Sensitivity, 1> red_green_sensitivity{{{1.0, 0.0053}}};
constexpr std::array<Sensitivity, 2> blue_yellow_sensitivity{{{34.1, 0.04}, {13.5, 0.025}}};
constexpr double widest_b = 0.04;

double sigma_px(double b) {
  return std::sqrt(b / (2.0 * pi * pi)) * flip_pixels_per_degree;
}

// A sum of Gaussians over the plane is not a product of sums over rows and columns: each is filtered by itself.
Plane as_seen(const Plane& plane, std::span<const Sensitivity> terms) {
  const int radius = static_cast<int>(std::ceil(3.0 * sigma_px(widest_b)));
  Plane sum{plane.width, plane.height, std::vector<double>(plane.values.size())};
  double total = 0.0;
  std::vector<double> weights;
  for (const Sensitivity& term : terms) {
    double along_a_line = 0.0;
    for (const double weight : gaussian(radius, sigma_px(term.b))) along_a_line += weight;
    weights.push_back(term.amplitude * std::sqrt(pi / term.b) * along_a_line * along_a_line);
    total += weights.back();
  }
  for (size_t i = 0; i < terms.size(); ++i) {
    const Kernel kernel = normalised(gaussian(radius, sigma_px(terms[i].b)));
    const Plane part = filtered(plane, kernel, kernel);
    for (size_t p = 0; p < sum.values.size(); ++p) sum.values[p] += weights[i] / total * part.values[p];
  }
  return sum;
}

Channels opponent_channels(const ColorSpaces& spaces, const Picture& picture) {
  std::array<double, 256> linear_of{};
  for (size_t i = 0; i < linear_of.size(); ++i) linear_of[i] = linear(static_cast<uint8_t>(i));
  Channels channels;
  channels.fill({picture.width, picture.height, {}});
  for (size_t i = 0; i < picture.shown.size(); i += 4) {
    const uint8_t* const p = &picture.shown[i];
    const glm::dvec3 c = ycxcz(spaces, {linear_of[p[0]], linear_of[p[1]], linear_of[p[2]]});
    for (int k = 0; k < 3; ++k) channels[static_cast<size_t>(k)].values.push_back(c[k]);
  }
  return channels;
}

// What is left of a picture's colours at this distance, ready to be compared.
Channels seen_colors(const ColorSpaces& spaces, const Channels& channels) {
  Channels seen{as_seen(channels[0], luminance_sensitivity), as_seen(channels[1], red_green_sensitivity),
                as_seen(channels[2], blue_yellow_sensitivity)};
  for (size_t i = 0; i < seen[0].values.size(); ++i) {
    const glm::dvec3 rgb = rgb_of_ycxcz(spaces, {seen[0].values[i], seen[1].values[i], seen[2].values[i]});
    const glm::dvec3 lab = hunt_lab(spaces, glm::clamp(rgb, 0.0, 1.0));
    for (int k = 0; k < 3; ++k) seen[static_cast<size_t>(k)].values[i] = lab[k];
  }
  return seen;
}

// Redistribution: differences up to a part of the largest possible one, green against blue, take most of the scale.
double scaled_color_difference(double difference, double largest) {
  const double knee = color_knee * largest;
  return difference < knee ? color_at_knee * difference / knee
                           : color_at_knee + (1.0 - color_at_knee) * (difference - knee) / (largest - knee);
}

// Feature detection: the Gaussian's derivatives, whose positive weights sum to 1 and negative ones to -1.
Kernel balanced(Kernel kernel) {
  double positive = 0.0, negative = 0.0;
  for (const double weight : kernel) (weight > 0.0 ? positive : negative) += std::abs(weight);
  for (double& weight : kernel) weight /= weight > 0.0 ? positive : negative;
  return kernel;
}

struct Features {
  Plane edges;
  Plane points;
};

Plane magnitude(Plane x, const Plane& y) {
  for (size_t i = 0; i < x.values.size(); ++i) x.values[i] = std::hypot(x.values[i], y.values[i]);
  return x;
}

// Of luminance 0..1.
Features features(Plane luminance) {
  for (double& y : luminance.values) y = (y + 16.0) / 116.0;
  const double sigma = 0.5 * feature_width_deg * flip_pixels_per_degree;
  const int radius = static_cast<int>(std::ceil(3.0 * sigma));
  const Kernel bell = gaussian(radius, sigma);
  Kernel slope = bell, bend = bell;
  for (int x = -radius; x <= radius; ++x) {
    slope[static_cast<size_t>(x + radius)] *= -x;
    bend[static_cast<size_t>(x + radius)] *= x * x / (sigma * sigma) - 1.0;
  }
  const Kernel even = normalised(bell), first = balanced(slope), second = balanced(bend);
  return {magnitude(filtered(luminance, first, even), filtered(luminance, even, first)),
          magnitude(filtered(luminance, second, even), filtered(luminance, even, second))};
}

}  // namespace

std::vector<float> flip_map(const Picture& a, const Picture& b) {
  const ColorSpaces spaces;
  const Channels channels_a = opponent_channels(spaces, a), channels_b = opponent_channels(spaces, b);
  const Features features_a = features(channels_a[0]), features_b = features(channels_b[0]);
  const Channels seen_a = seen_colors(spaces, channels_a), seen_b = seen_colors(spaces, channels_b);
  const double largest = std::pow(hyab(hunt_lab(spaces, {0, 1, 0}), hunt_lab(spaces, {0, 0, 1})), color_exponent);
  std::vector<float> map(channels_a[0].values.size());
  for (size_t i = 0; i < map.size(); ++i) {
    const auto lab = [i](const Channels& seen) {
      return glm::dvec3(seen[0].values[i], seen[1].values[i], seen[2].values[i]);
    };
    const double color = scaled_color_difference(std::pow(hyab(lab(seen_a), lab(seen_b)), color_exponent), largest);
    const double feature = std::max(std::abs(features_a.edges.values[i] - features_b.edges.values[i]),
                                    std::abs(features_a.points.values[i] - features_b.points.values[i]));
    // A difference of features raises that of colours.
    map[i] = static_cast<float>(std::pow(color, 1.0 - std::pow(feature / std::numbers::sqrt2, feature_exponent)));
  }
  return map;
}

}  // namespace chandelier::player
