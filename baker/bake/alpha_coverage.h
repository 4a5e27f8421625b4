// SPDX-License-Identifier: Apache-2.0
// Keeps the visible area of an alpha-tested image the same on every mip level.
#pragma once

#include <cstdint>
#include <vector>

namespace chandelier::baker {

/// Share of the texels of an RGBA8 image whose alpha is at least `cutoff`.
double alpha_coverage(const std::vector<uint8_t>& rgba, float cutoff);

/// `alphas` scaled so that the share that reaches `cutoff` (above 0, at most 1) is as near to `coverage` as possible,
/// in steps of 1/255. Equal alphas stay equal, so where many are equal, coverage is missed by up to their number.
/// Castaño 2010, Computing Alpha Mipmaps, but with an exact scale in place of a search.
std::vector<uint8_t> with_coverage(const std::vector<float>& alphas, float cutoff, double coverage);

}  // namespace chandelier::baker
