// SPDX-License-Identifier: Apache-2.0
// SSIM: how alike two pictures' structures are (Wang, Bovik, Sheikh and Simoncelli 2004, Image Quality Assessment: From
// Error Visibility to Structural Similarity).
#pragma once

#include <optional>

#include "frame/renderer.h"

namespace chandelier::player {

/// Of the shown pictures, sRGB values 0..1: the mean over R, G and B of each channel's mean SSIM; 1 where they are
/// equal. Wang's window and constants: 11×11 texels of a Gaussian of sigma 1.5, K1 0.01, K2 0.03, variances without
/// Bessel's correction, over the pixels whose window lies within the picture. Nothing where no window fits. Both of one
/// size.
std::optional<double> ssim(const Picture& a, const Picture& b);

}  // namespace chandelier::player
