// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace chandelier {

/// Depth of one cube of store `cube-array`.
constexpr uint64_t cube_bytes(uint32_t face_size_px) {
  return uint64_t{6} * 4 * face_size_px * face_size_px;
}

}  // namespace chandelier
