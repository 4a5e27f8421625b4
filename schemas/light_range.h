// SPDX-License-Identifier: Apache-2.0
// The range of a light without an authored one: one rule for the baker and for previews.
#pragma once

#include <algorithm>
#include <cfloat>
#include <cmath>
#include <glm/vec3.hpp>

namespace chandelier::pack {

constexpr float default_range_threshold_lx = 0.05f;

/// The distance at which the light's illuminance, falling with its square, is `threshold_lx`.
inline float derived_range_m(float intensity_cd, const glm::vec3& color, float threshold_lx) {
  const double brightest_cd = double{intensity_cd} * std::max({color.r, color.g, color.b});
  return static_cast<float>(std::min(std::sqrt(brightest_cd / double{threshold_lx}), double{FLT_MAX}));
}

}  // namespace chandelier::pack
