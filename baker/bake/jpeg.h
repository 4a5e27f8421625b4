// SPDX-License-Identifier: Apache-2.0
// Looks at a JPEG before the decoder does.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace chandelier::baker {

/// Throws Error, beginning with `where`, where the file ends before its image does.
void check_jpeg(const std::vector<std::uint8_t>& bytes, const std::string& where);

/// Width times height as its frame header claims, unchecked; 0 where there is none.
std::uint64_t jpeg_texels(const std::vector<std::uint8_t>& bytes);

}  // namespace chandelier::baker
