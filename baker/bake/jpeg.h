// SPDX-License-Identifier: Apache-2.0
// Checks a JPEG before it is decoded.
#pragma once

#include <cstdint>
#include <vector>

#include "claimed_size.h"

namespace chandelier::baker {

/// Whether the file ends where its image does, and not before.
bool is_whole_jpeg(const std::vector<uint8_t>& bytes);

/// As its frame header claims it.
ClaimedSize jpeg_size(const std::vector<uint8_t>& bytes);

}  // namespace chandelier::baker
