// SPDX-License-Identifier: Apache-2.0
// Checks and repairs a PNG before it is decoded.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "claimed_size.h"

namespace chandelier::baker {

/// The chunks of a PNG that its texels need: glTF ignores colour profiles and gamma, and the decoder would print
/// warnings about them. Damage that viewers tolerate is repaired, and `damage` then names it: a chunk with a wrong
/// checksum, a file that is cut short, data that ends early or cannot be inflated from some row on (that row and those
/// below repeat the last good one). Throws Error, beginning with `where`, if no picture is left.
std::vector<uint8_t> essential_png(const std::vector<uint8_t>& bytes, const std::string& where, std::string& damage);

/// The size in the header.
ClaimedSize png_size(const std::vector<uint8_t>& bytes);

}  // namespace chandelier::baker
