// SPDX-License-Identifier: Apache-2.0
// Looks at a PNG before the decoder does.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace chandelier::baker {

/// The chunks of a PNG that its texels need: glTF ignores colour profiles and gamma, and the decoder would print
/// warnings about them. Throws Error, beginning with `where`, where the file is cut or a checksum is wrong.
std::vector<std::uint8_t> essential_png(const std::vector<std::uint8_t>& bytes, const std::string& where);

/// Width times height as its header claims, unchecked; 0 where there is no header.
std::uint64_t png_texels(const std::vector<std::uint8_t>& bytes);

}  // namespace chandelier::baker
