// SPDX-License-Identifier: Apache-2.0
// Colours for maps of errors.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace chandelier::player {

using ColorMap = std::array<uint8_t, 3> (*)(float);

/// Dark blue at 0, cyan, yellow, red at 1; sRGB.
std::array<uint8_t, 3> heat_color(float t);
/// Black at 0, purple, orange, pale yellow at 1: magma of Smith and van der Walt (matplotlib), within 3 of 255.
std::array<uint8_t, 3> magma_color(float t);

/// Rows of R, G and B; `scale` is drawn as 1.
std::vector<uint8_t> colored(std::span<const float> values, float scale, ColorMap colors);

}  // namespace chandelier::player
