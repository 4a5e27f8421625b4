// SPDX-License-Identifier: Apache-2.0
#include "lights/shown_curve.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>

namespace chandelier {
namespace {

// A float's bits grow with its value, and evenly within an octave: 128 entries for each from 2^-14 to 2^6.
constexpr uint32_t first_bits = (127u - 14u) << 23;
constexpr uint32_t entries = 20u << 7;
constexpr uint32_t step_bits = 16;  // a step is so many lowest bits

}  // namespace

float shown(float exposed) {
  const float x = std::clamp(exposed, 0.0f, 1e4f);
  const float film = std::clamp(x * (2.51f * x + 0.03f) / (x * (2.43f * x + 0.59f) + 0.14f), 0.0f, 1.0f);
  return film <= 0.0031308f ? film * 12.92f : 1.055f * std::pow(film, 1.0f / 2.4f) - 0.055f;
}

ShownCurve::ShownCurve() {
  for (uint32_t i = 0; i <= entries; ++i) values_.push_back(shown(std::bit_cast<float>(first_bits + (i << step_bits))));
}

float ShownCurve::operator()(float exposed) const {
  const uint32_t bits = std::bit_cast<uint32_t>(std::max(exposed, std::bit_cast<float>(first_bits))) - first_bits;
  const uint32_t i = std::min(bits >> step_bits, entries - 1);
  const float part = static_cast<float>(std::min(bits - (i << step_bits), 1u << step_bits)) * 0x1p-16f;
  return values_[i] + (values_[i + 1] - values_[i]) * part;
}

}  // namespace chandelier
