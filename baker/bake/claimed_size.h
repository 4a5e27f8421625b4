// SPDX-License-Identifier: Apache-2.0
// The size in an image's header, read before anything is decoded.
#pragma once

#include <cstddef>
#include <cstdint>

namespace chandelier::baker {

/// Not checked; 0 × 0 if there is no header.
struct ClaimedSize {
  uint64_t width = 0, height = 0;

  uint64_t texels() const { return width * height; }
};

/// Whether a file has less than one byte per 2048 texels. No format needs so little, so the size in its header is
/// wrong.
inline bool has_no_picture(const ClaimedSize& size, size_t file_bytes) {
  return size.texels() / 2048 > file_bytes;
}

}  // namespace chandelier::baker
