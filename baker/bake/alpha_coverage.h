// SPDX-License-Identifier: Apache-2.0
// Keeps what is seen of an alpha-tested image as large on every mip level as on the first.
#pragma once

#include <cstdint>
#include <vector>

namespace chandelier::baker {

/// Share of the texels of an RGBA8 image whose alpha is at least `cutoff`.
double alpha_coverage(const std::vector<std::uint8_t>& rgba, float cutoff);

/// `alphas` scaled so that as near as can be `coverage` of them reach `cutoff`, which is above 0 and at most 1; in
/// steps of 1/255. Equal ones stay equal, so that where many are equal coverage is missed by up to their number.
/// Castaño 2010, Computing Alpha Mipmaps; but exact, where that searches for the scale.
std::vector<std::uint8_t> with_coverage(const std::vector<float>& alphas, float cutoff, double coverage);

}  // namespace chandelier::baker
