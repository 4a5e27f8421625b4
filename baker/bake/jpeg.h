// SPDX-License-Identifier: Apache-2.0
// Looks at a JPEG before the decoder does.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace chandelier::baker {

/// Throws Error, beginning with `where`, where the file ends before its image does.
void check_jpeg(const std::vector<std::uint8_t>& bytes, const std::string& where);

}  // namespace chandelier::baker
