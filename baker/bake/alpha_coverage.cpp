// SPDX-License-Identifier: Apache-2.0
// Alpha coverage by order statistics: the scale that brings the right number of texels over the cutoff.
#include "alpha_coverage.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <functional>
#include <limits>

namespace chandelier::baker {
namespace {

/// The smallest 8-bit alpha that passes a shader's alpha test; 256 if none passes.
int first_passing_code(float cutoff) {
  int code = 0;
  while (code < 256 && static_cast<float>(code) / 255.0f < cutoff) ++code;
  return code;
}

/// The threshold between the texels that must pass and the others.
struct Threshold {
  float passing;  // the smallest alpha that passes; infinity: none passes
  float failing;  // the largest alpha that fails; -infinity: all pass
};

Threshold find_threshold(std::vector<float> alphas, size_t count) {
  constexpr float infinite = std::numeric_limits<float>::infinity();
  const auto nth = alphas.begin() + static_cast<ptrdiff_t>(std::max<size_t>(count, 1) - 1);
  std::nth_element(alphas.begin(), nth, alphas.end(), std::greater<>());
  const float value = *nth;
  size_t above = 0, equal = 0;
  float next_above = infinite, next_below = -infinite;
  for (const float alpha : alphas) {
    if (alpha > value) ++above, next_above = std::min(next_above, alpha);
    if (alpha < value) next_below = std::max(next_below, alpha);
    equal += alpha == value;
  }
  // Those that equal the threshold pass or fail together.
  const bool pass = count > 0 && above + equal - count <= count - above;
  return pass ? Threshold{value, next_below} : Threshold{next_above, value};
}

}  // namespace

double alpha_coverage(const std::vector<uint8_t>& rgba, float cutoff) {
  const int first = first_passing_code(cutoff);
  size_t passing = 0;
  for (size_t i = 3; i < rgba.size(); i += 4) passing += rgba[i] >= first;
  return static_cast<double>(passing) / static_cast<double>(rgba.size() / 4);
}

std::vector<uint8_t> with_coverage(const std::vector<float>& alphas, float cutoff, double coverage) {
  const int first = first_passing_code(cutoff);
  const auto count = static_cast<size_t>(std::llround(coverage * static_cast<double>(alphas.size())));
  const Threshold threshold = find_threshold(alphas, count);
  float scale = 1;  // changed as little as necessary
  if (threshold.passing > 0 && threshold.passing < cutoff) scale = cutoff / threshold.passing;
  if (threshold.failing >= cutoff) scale = cutoff / threshold.failing;
  std::vector<uint8_t> out(alphas.size());
  for (size_t i = 0; i < alphas.size(); ++i) {
    const int code = static_cast<int>(std::clamp(alphas[i] * scale, 0.0f, 1.0f) * 255.0f + 0.5f);
    const bool passes = alphas[i] >= threshold.passing;  // rounding must not change this
    out[i] = static_cast<uint8_t>(passes ? std::max(code, first) : std::min(code, first - 1));
  }
  return out;
}

}  // namespace chandelier::baker
