// SPDX-License-Identifier: Apache-2.0
// Corners of triangles in meshoptimizer's index code: the content of sections with the codec triangles, before zstd.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace chandelier::pack {

/// False in a build without meshoptimizer, which can neither write nor read this codec.
bool has_triangle_codec();

/// 32 bits to add to every corner, then for each triangle the number of corners by which it is turned, then the code.
/// `corners` are three a triangle. `base` should be near them: one above the largest before them is best.
std::vector<std::byte> to_triangle_code(std::span<const uint32_t> corners, uint32_t base);

/// The inverse. False if `coded` is malformed; any other content gives some corners.
[[nodiscard]] bool from_triangle_code(std::span<const std::byte> coded, std::span<uint32_t> corners);

/// Most bytes that to_triangle_code() can return for so many corners.
size_t triangle_code_bound(size_t corner_count);

}  // namespace chandelier::pack
