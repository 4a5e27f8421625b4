// SPDX-License-Identifier: Apache-2.0
// Looks at a PNG before the decoder does.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "claimed_size.h"

namespace chandelier::baker {

/// The chunks of a PNG that its texels need: glTF ignores colour profiles and gamma, and the decoder would print
/// warnings about them. What viewers show although it is damaged is made whole, and `damage` then says what was wrong:
/// chunks whose checksum is wrong, a file that is cut short, data that ends early or cannot be inflated from some row
/// on (which and those below repeat the last good one). Throws Error, beginning with `where`, where that is no picture.
std::vector<std::uint8_t> essential_png(const std::vector<std::uint8_t>& bytes, const std::string& where,
                                        std::string& damage);

/// As its header claims it.
ClaimedSize png_size(const std::vector<std::uint8_t>& bytes);

}  // namespace chandelier::baker
