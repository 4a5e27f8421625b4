// SPDX-License-Identifier: Apache-2.0
// FLIP for pictures as shown: how different two pictures look to someone who flips between them (Andersson, Nilsson,
// Akenine-Möller, Oskarsson, Åström and Fairchild 2020, FLIP: A Difference Evaluator for Alternating Images).
#pragma once

#include <numbers>
#include <vector>

#include "frame/renderer.h"

namespace chandelier::player {

/// The paper's viewer: 0.7 m before a screen 0.7 m wide with 3840 pixels; about 67.
constexpr double flip_pixels_per_degree = 0.7 * (3840.0 / 0.7) * std::numbers::pi / 180.0;

/// Per pixel of the shown pictures, rows from the top: 0 where they look alike, 1 where they could not differ more. It
/// does not matter which of the two is which. Both of one size.
std::vector<float> flip_map(const Picture& a, const Picture& b);

}  // namespace chandelier::player
