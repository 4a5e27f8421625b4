// SPDX-License-Identifier: Apache-2.0
// Decodes PNG, JPEG and WebP files into texels.
#pragma once

#include <cstdint>
#include <string>

#include "../scene.h"
#include "claimed_size.h"
#include "mips.h"

namespace chandelier::baker {

/// Throws Error unless both sides are 1 to 16384 texels.
void check_image_size(int64_t width, int64_t height, const std::string& where);

/// A decoded image. `damage` says what is wrong with a file of which only a part could be decoded; the other texels are
/// filled in, as image viewers do.
struct DecodedTexels {
  Texels texels;
  std::string damage;
};

/// Throws Error if the file is neither PNG, JPEG nor WebP, cannot be decoded or is too large.
DecodedTexels decode_image(const EncodedImage& image);

/// The bytes of the decoder module's file, for cache keys: equal modules decode alike. Empty if it is missing.
const std::string& decoder_code();

/// The size in the header of a file of any of the three formats.
ClaimedSize claimed_size(const EncodedImage& image);

}  // namespace chandelier::baker
