// SPDX-License-Identifier: Apache-2.0
// What an image's header says before anything is decoded.
#pragma once

#include <cstddef>
#include <cstdint>

namespace chandelier::baker {

/// Unchecked; 0 by 0 where there is no header.
struct ClaimedSize {
  uint64_t width = 0, height = 0;

  uint64_t texels() const { return width * height; }
};

/// Less than a byte for 2048 texels, far less than any format needs: the size in such a damaged file is not plausible.
inline bool has_no_picture(const ClaimedSize& size, size_t file_bytes) {
  return size.texels() / 2048 > file_bytes;
}

}  // namespace chandelier::baker
