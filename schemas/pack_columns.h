// SPDX-License-Identifier: Apache-2.0
// Records rearranged so that zstd compresses them better: the content of sections with the codec columns, before zstd.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

namespace chandelier::pack {

/// How one column, the i-th 32-bit word of every record, is laid out.
enum class Layout : uint8_t {
  records,       ///< With the other columns of this layout, record after record.
  planes,        ///< All lowest bytes, then all second ones, then all third ones, then all highest ones.
  delta_planes,  ///< The same of differences to the record before, signs folded into the lowest bit.
};
inline constexpr uint32_t layout_count = 3;

using Layouts = std::vector<Layout>;  // one a column

/// Finds layouts under which `cost` of the coded records is small. `stride` is a multiple of four.
Layouts choose_layouts(std::span<const std::byte> records, size_t stride,
                       const std::function<size_t(std::span<const std::byte>)>& cost);

/// Four bytes a column (layout, whether it is scaled, 16 bits of exponent), the columns laid out as records, then the
/// others. A column of floats that are all multiples of a power of two becomes integers where nothing is lost.
std::vector<std::byte> to_columns(std::span<const std::byte> records, size_t stride, const Layouts& layouts);

/// The inverse. False if `coded` is malformed; any other content gives some records.
[[nodiscard]] bool from_columns(std::span<const std::byte> coded, size_t stride, std::span<std::byte> records);

/// Bytes that to_columns() returns.
size_t columns_bytes(size_t record_bytes, size_t stride);

}  // namespace chandelier::pack
