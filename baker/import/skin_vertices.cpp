// SPDX-License-Identifier: Apache-2.0
// Weights are kept in 16 bits each: their error, at most 1/65535, moves a vertex less than its position's rounding.
#include "skin_vertices.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace chandelier::baker {
namespace {

constexpr float whole_tolerance = 0.01f;  // 8-bit weights that each are rounded sum to within 4 · 0.5 / 255 of 1

bool is_unsigned_short(int type) {
  return type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE || type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT;
}

void check_types(const Elements& joints, const Elements& weights, const std::string& where) {
  if (!is_unsigned_short(joints.component_type)) {
    fail(where + ", attribute JOINTS_0",
         "component type is not unsigned byte or short (" + std::to_string(joints.component_type) + ")");
  }
  if (weights.component_type != TINYGLTF_COMPONENT_TYPE_FLOAT && !is_unsigned_short(weights.component_type)) {
    fail(where + ", attribute WEIGHTS_0",
         "component type is not float, unsigned byte or short (" + std::to_string(weights.component_type) + ")");
  }
}

}  // namespace

std::array<uint16_t, 4> quantize_weights(const std::array<float, 4>& weights) {
  const double sum = std::accumulate(weights.begin(), weights.end(), 0.0);
  if (!(sum > 0)) return {65535, 0, 0, 0};
  std::array<uint16_t, 4> out{};
  std::array<double, 4> remainders{};
  int left = 65535;
  for (size_t i = 0; i < 4; ++i) {
    const double exact = weights[i] / sum * 65535;
    out[i] = static_cast<uint16_t>(exact);
    remainders[i] = exact - out[i];
    left -= out[i];
  }
  for (; left > 0; --left) {  // at most 3, since four remainders are each below 1
    const auto most = std::max_element(remainders.begin(), remainders.end()) - remainders.begin();
    ++out[static_cast<size_t>(most)];
    remainders[static_cast<size_t>(most)] = -1;
  }
  return out;
}

std::vector<SkinVertex> read_skin_vertices(const Elements& joints, const Elements& weights, const std::string& where,
                                           std::vector<std::string>& warnings) {
  check_types(joints, weights, where);
  // Joints are numbers and integer weights are shares, whatever the accessors' flags say.
  const Elements whole = {joints.data, joints.stride, joints.count, 4, joints.component_type, false, {}};
  const Elements part = {weights.data, weights.stride, weights.count, 4, weights.component_type, true, {}};
  std::vector<SkinVertex> out(joints.count);
  FirstFault not_finite, negative, uneven;
  for_blocks(out.size(), [&](size_t first, size_t count) {
    std::array<float, 4096> numbers, shares;
    to_floats(whole, first, count, numbers.data());
    const size_t bad = to_floats(part, first, count, shares.data());
    if (bad != SIZE_MAX) return not_finite.note(bad);
    for (size_t i = 0; i < count; ++i) {
      const std::array<float, 4> w = {shares[4 * i], shares[4 * i + 1], shares[4 * i + 2], shares[4 * i + 3]};
      if (*std::min_element(w.begin(), w.end()) < 0) return negative.note(first + i);
      if (std::abs(w[0] + w[1] + w[2] + w[3] - 1) > whole_tolerance) uneven.note(first + i);
      SkinVertex& vertex = out[first + i];
      vertex.weights = quantize_weights(w);
      for (size_t k = 0; k < 4; ++k) {
        vertex.joints[k] = vertex.weights[k] ? static_cast<uint16_t>(numbers[4 * i + k]) : uint16_t{0};
      }
    }
  });
  const std::string place = where + ", attribute WEIGHTS_0";
  if (not_finite.at() != SIZE_MAX) fail_not_finite(weights, not_finite.at(), place);
  if (negative.at() != SIZE_MAX) fail(place, "a weight is negative (vertex " + std::to_string(negative.at()) + ")");
  if (uneven.at() != SIZE_MAX) warnings.push_back("weights that do not sum to 1 are scaled");
  return out;
}

}  // namespace chandelier::baker
