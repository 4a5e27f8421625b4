// SPDX-License-Identifier: Apache-2.0
// Joints and weights of vertices.
#pragma once

#include <array>
#include <cstdint>

#include "../scene.h"
#include "accessor.h"

namespace chandelier::baker {

/// Weights as unorm16 that sum to exactly 65535, by largest remainder. None may be negative; all zero: the first has
/// all.
std::array<uint16_t, 4> quantize_weights(const std::array<float, 4>& weights);

/// JOINTS_0 and WEIGHTS_0 of every vertex. A joint without weight is joint 0. Throws Error; repairs are reported in
/// `warnings`.
std::vector<SkinVertex> read_skin_vertices(const Elements& joints, const Elements& weights, const std::string& where,
                                           std::vector<std::string>& warnings);

}  // namespace chandelier::baker
