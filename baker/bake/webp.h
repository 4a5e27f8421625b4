// SPDX-License-Identifier: Apache-2.0
// Looks into a WebP file (RFC 9649): a RIFF container of chunks.
#pragma once

#include <cstdint>
#include <vector>

#include "claimed_size.h"

namespace chandelier::baker {

/// A copy that does not say that it has alpha, so that it decodes to its colours alone.
std::vector<std::uint8_t> webp_without_alpha(const std::vector<std::uint8_t>& bytes);

/// As its first chunk claims it.
ClaimedSize webp_size(const std::vector<std::uint8_t>& bytes);

}  // namespace chandelier::baker
