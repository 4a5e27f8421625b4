// SPDX-License-Identifier: Apache-2.0
// PNG, JPEG and WebP bytes into texels.
#pragma once

#include <cstdint>
#include <string>

#include "../scene.h"
#include "claimed_size.h"
#include "mips.h"

namespace chandelier::baker {

/// Throws Error above 16384 texels, or below 1.
void check_image_size(int64_t width, int64_t height, const std::string& where);

/// An image, and the damage of its file if something is still visible, as in viewers. Part of the texels may then be
/// filled in.
struct DecodedTexels {
  Texels texels;
  std::string damage;
};

/// Throws Error for what is neither PNG, JPEG nor WebP, cannot be decoded or is too large.
DecodedTexels decode_image(const EncodedImage& image);

/// The file of the decoder module, byte for byte: equal modules decode alike. Empty if it is missing.
const std::string& decoder_code();

/// Of a file of any of the three formats.
ClaimedSize claimed_size(const EncodedImage& image);

}  // namespace chandelier::baker
