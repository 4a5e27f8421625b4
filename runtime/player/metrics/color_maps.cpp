// SPDX-License-Identifier: Apache-2.0
#include "player/metrics/color_maps.h"

#include <algorithm>
#include <cmath>

namespace chandelier::player {
namespace {

using Stop = std::array<float, 3>;

// Evenly spaced stops, straight lines between them.
std::array<uint8_t, 3> color_along(std::span<const Stop> stops, float t) {
  const float at = std::clamp(t, 0.0f, 1.0f) * static_cast<float>(stops.size() - 1);
  const size_t i = std::min(static_cast<size_t>(at), stops.size() - 2);
  const float part = at - static_cast<float>(i);
  std::array<uint8_t, 3> color{};
  for (size_t c = 0; c < 3; ++c)
    color[c] = static_cast<uint8_t>(std::lround(stops[i][c] + part * (stops[i + 1][c] - stops[i][c])));
  return color;
}

}  // namespace

std::array<uint8_t, 3> heat_color(float t) {
  static constexpr std::array<Stop, 5> color_stops{
      {{0, 0, 90}, {0, 60, 200}, {0, 220, 255}, {255, 230, 0}, {255, 0, 0}}};
  return color_along(color_stops, t);
}

std::array<uint8_t, 3> magma_color(float t) {
  static constexpr std::array<Stop, 17> color_stops{{{0, 0, 4},
                                                     {10, 8, 34},
                                                     {29, 17, 71},
                                                     {54, 16, 107},
                                                     {81, 18, 124},
                                                     {106, 28, 129},
                                                     {131, 38, 129},
                                                     {156, 46, 127},
                                                     {183, 55, 121},
                                                     {207, 64, 112},
                                                     {229, 80, 100},
                                                     {244, 105, 92},
                                                     {251, 135, 97},
                                                     {254, 165, 113},
                                                     {254, 194, 135},
                                                     {253, 224, 161},
                                                     {252, 253, 191}}};
  return color_along(color_stops, t);
}

std::vector<uint8_t> colored(std::span<const float> values, float scale, ColorMap colors) {
  std::vector<uint8_t> rgb;
  rgb.reserve(values.size() * 3);
  for (const float value : values) {
    const auto color = colors(value / scale);
    rgb.insert(rgb.end(), color.begin(), color.end());
  }
  return rgb;
}

}  // namespace chandelier::player
