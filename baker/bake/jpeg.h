// SPDX-License-Identifier: Apache-2.0
// Checks a JPEG before it is decoded.
#pragma once

#include <cstdint>
#include <vector>

#include "claimed_size.h"

namespace chandelier::baker {

/// Whether the file is complete: it has the marker that ends the image.
bool is_whole_jpeg(const std::vector<uint8_t>& bytes);

/// The size in the frame header.
ClaimedSize jpeg_size(const std::vector<uint8_t>& bytes);

}  // namespace chandelier::baker
