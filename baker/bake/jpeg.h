// SPDX-License-Identifier: Apache-2.0
// Looks at a JPEG before the decoder does.
#pragma once

#include <cstdint>
#include <vector>

namespace chandelier::baker {

/// Whether the file ends where its image does, and not before.
bool is_whole_jpeg(const std::vector<std::uint8_t>& bytes);

/// Width times height as its frame header claims, unchecked; 0 where there is none.
std::uint64_t jpeg_texels(const std::vector<std::uint8_t>& bytes);

}  // namespace chandelier::baker
