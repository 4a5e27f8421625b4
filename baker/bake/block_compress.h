// SPDX-License-Identifier: Apache-2.0
// Compresses RGBA8 into blocks of 4×4 texels that GPUs sample directly.
#pragma once

#include <cstdint>

#include "mips.h"

namespace chandelier::baker {

enum class BlockFormat {
  bc1,  // RGB, 8 bytes a block
  bc3,  // RGBA, 16 bytes
  bc5,  // red and green, 16 bytes
};

struct Blocks {
  std::vector<uint8_t> bytes;  // rows of blocks from the top
  uint64_t squared_error = 0;  // of all 8-bit values that the format keeps
  uint64_t values = 0;         // their number; colours that alpha 0 hides do not count
};

/// Makes ⌈size / 4⌉ blocks per side. A block that extends past the edge is fitted to the texels inside the image. The
/// result does not depend on the number of threads.
Blocks compress_blocks(const Texels& texels, BlockFormat format);

}  // namespace chandelier::baker
