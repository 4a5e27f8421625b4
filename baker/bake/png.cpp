// SPDX-License-Identifier: Apache-2.0
// PNG (ISO/IEC 15948) as a row of chunks: length, type, data, CRC-32.
#include "png.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <string_view>

#include "../error.h"

namespace chandelier::baker {
namespace {

constexpr std::size_t kSignatureBytes = 8;

std::uint32_t u32_at(const std::vector<std::uint8_t>& bytes, std::size_t at) {
  return std::uint32_t{bytes[at]} << 24 | std::uint32_t{bytes[at + 1]} << 16 | std::uint32_t{bytes[at + 2]} << 8 |
         bytes[at + 3];
}

/// Of type and data; Annex D.
std::uint32_t crc_of(const std::uint8_t* data, std::size_t size) {
  static const std::array<std::uint32_t, 256> table = [] {
    std::array<std::uint32_t, 256> out{};
    for (std::uint32_t i = 0; i < 256; ++i) {
      std::uint32_t c = i;
      for (int bit = 0; bit < 8; ++bit) c = c & 1 ? 0xEDB88320u ^ c >> 1 : c >> 1;
      out[i] = c;
    }
    return out;
  }();
  std::uint32_t crc = 0xFFFFFFFFu;
  for (std::size_t i = 0; i < size; ++i) crc = table[(crc ^ data[i]) & 0xFF] ^ crc >> 8;
  return ~crc;
}

bool is_essential(std::string_view type) {
  return type == "IHDR" || type == "PLTE" || type == "tRNS" || type == "IDAT" || type == "IEND";
}

}  // namespace

std::vector<std::uint8_t> essential_png(const std::vector<std::uint8_t>& bytes, const std::string& where) {
  if (bytes.size() < kSignatureBytes) fail(where, "PNG is cut short (" + std::to_string(bytes.size()) + " bytes)");
  std::vector<std::uint8_t> out(bytes.begin(), bytes.begin() + kSignatureBytes);
  for (std::size_t at = kSignatureBytes;;) {
    // 12: length, type and checksum
    if (bytes.size() - at < 12 || bytes.size() - at - 12 < u32_at(bytes, at)) {
      fail(where, "PNG is cut short (" + std::to_string(bytes.size()) + " bytes)");
    }
    const std::size_t size = u32_at(bytes, at);
    std::string type(bytes.begin() + static_cast<std::ptrdiff_t>(at + 4),
                     bytes.begin() + static_cast<std::ptrdiff_t>(at + 8));
    if (crc_of(bytes.data() + at + 4, size + 4) != u32_at(bytes, at + 8 + size)) {
      std::replace_if(
          type.begin(), type.end(), [](unsigned char c) { return !std::isprint(c); }, '?');
      fail(where, "PNG is damaged: the checksum of chunk " + type + " at byte " + std::to_string(at) + " is wrong");
    }
    const auto begin = bytes.begin() + static_cast<std::ptrdiff_t>(at);
    if (is_essential(type)) out.insert(out.end(), begin, begin + static_cast<std::ptrdiff_t>(size + 12));
    if (type == "IEND") return out;
    at += size + 12;
  }
}

}  // namespace chandelier::baker
