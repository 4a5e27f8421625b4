// SPDX-License-Identifier: Apache-2.0
// Reads the header of a WebP file (RFC 9649), a RIFF container of chunks.
#pragma once

#include <cstdint>
#include <vector>

#include "claimed_size.h"

namespace chandelier::baker {

/// A copy whose header says that there is no alpha, so that a decoder returns the colours without alpha.
std::vector<uint8_t> webp_without_alpha(const std::vector<uint8_t>& bytes);

/// The size in the first chunk.
ClaimedSize webp_size(const std::vector<uint8_t>& bytes);

}  // namespace chandelier::baker
