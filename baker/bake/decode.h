// SPDX-License-Identifier: Apache-2.0
// PNG and JPEG bytes into texels.
#pragma once

#include <string>

#include "../scene.h"
#include "mips.h"

namespace chandelier::baker {

/// Throws Error above 16384 texels, or below 1.
void check_image_size(std::int64_t width, std::int64_t height, const std::string& where);

/// Throws Error for what is neither PNG nor JPEG, is damaged or too large.
Texels decode_image(const EncodedImage& image);

/// What decodes, as it lies on the disk: equal ones decode alike. Empty where it is missing.
const std::string& decoder_code();

/// Width times height as the header claims, unchecked; 0 where there is none.
std::uint64_t claimed_texels(const EncodedImage& image);

}  // namespace chandelier::baker
