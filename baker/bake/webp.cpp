// SPDX-License-Identifier: Apache-2.0
// Alpha is announced by a bit of the chunk VP8X (RFC 9649, 2.7) and stored in a chunk ALPH, or announced by a bit of a
// lossless image's header (3.4).
#include "webp.h"

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <string_view>

namespace chandelier::baker {
namespace {

constexpr size_t file_header = 12, chunk_header = 8;
constexpr uint8_t extended_alpha = 0x10;  // of VP8X's first byte
constexpr size_t lossless_alpha_at = 4;   // a byte of signature, 14 bits of width, 14 of height, then the bit
constexpr uint8_t lossless_alpha = 0x10;

uint32_t u32_at(const uint8_t* bytes) {
  return uint32_t{bytes[3]} << 24 | uint32_t{bytes[2]} << 16 | uint32_t{bytes[1]} << 8 | bytes[0];
}

bool is(const uint8_t* chunk, std::string_view type) {
  return std::memcmp(chunk, type.data(), 4) == 0;
}

/// A chunk's bytes with its header and padding, as far as they are there.
size_t size_of_chunk(const std::vector<uint8_t>& bytes, size_t at) {
  const size_t left = bytes.size() - at, size = u32_at(&bytes[at + 4]);
  return std::min(left, chunk_header + size + size % 2);
}

}  // namespace

std::vector<uint8_t> webp_without_alpha(const std::vector<uint8_t>& bytes) {
  if (bytes.size() < file_header) return bytes;
  std::vector<uint8_t> out(bytes.begin(), bytes.begin() + file_header);
  for (size_t at = file_header; bytes.size() - at >= chunk_header;) {
    const size_t size = size_of_chunk(bytes, at);
    const auto chunk = bytes.begin() + static_cast<ptrdiff_t>(at);
    if (!is(&bytes[at], "ALPH")) {
      const size_t data = out.size() + chunk_header;
      out.insert(out.end(), chunk, chunk + static_cast<ptrdiff_t>(size));
      if (is(&bytes[at], "VP8X") && size > chunk_header) out[data] &= static_cast<uint8_t>(~extended_alpha);
      if (is(&bytes[at], "VP8L") && size > chunk_header + lossless_alpha_at) {
        out[data + lossless_alpha_at] &= static_cast<uint8_t>(~lossless_alpha);
      }
    }
    at += size;
  }
  const auto riff = static_cast<uint32_t>(out.size() - 8);
  for (size_t i = 0; i < 4; ++i) out[4 + i] = static_cast<uint8_t>(riff >> 8 * i);
  return out;
}

ClaimedSize webp_size(const std::vector<uint8_t>& bytes) {
  if (bytes.size() < file_header + chunk_header + 10) return {};
  const uint8_t *chunk = &bytes[file_header], *data = chunk + chunk_header;
  if (is(chunk, "VP8X")) {  // 24 bits each, less one
    return {(u32_at(data + 4) & 0xFFFFFF) + 1, (u32_at(data + 6) >> 8) + 1};
  }
  if (is(chunk, "VP8L")) {  // 14 bits each, less one
    const uint32_t bits = u32_at(data + 1);
    return {(bits & 0x3FFF) + 1, (bits >> 14 & 0x3FFF) + 1};
  }
  if (!is(chunk, "VP8 ")) return {};
  return {u32_at(data + 6) & 0x3FFF, u32_at(data + 6) >> 16 & 0x3FFF};  // after a tag and a start code
}

}  // namespace chandelier::baker
