// SPDX-License-Identifier: Apache-2.0
// JPEG (ITU-T T.81, Annex B) as a row of marker segments: a decoder fills what is missing with grey and says nothing.
#include "jpeg.h"

#include "../error.h"

namespace chandelier::baker {
namespace {

constexpr std::uint8_t kEndOfImage = 0xD9, kFirstRestart = 0xD0, kStartOfImage = 0xD8, kTemporary = 0x01;

/// Markers without a length of their own.
bool stands_alone(std::uint8_t marker) {
  return (marker >= kFirstRestart && marker <= kStartOfImage) || marker == kTemporary;
}

}  // namespace

void check_jpeg(const std::vector<std::uint8_t>& bytes, const std::string& where) {
  // Between segments lie the scans' data, in which FF is followed by 00, or by more FF before a marker.
  for (std::size_t at = 0; at + 1 < bytes.size();) {
    const std::uint8_t marker = bytes[at + 1];
    if (bytes[at] != 0xFF || marker == 0xFF) {
      ++at;
    } else if (marker == 0 || stands_alone(marker)) {
      at += 2;
    } else if (marker == kEndOfImage) {
      return;
    } else if (at + 3 < bytes.size()) {
      at += 2 + (std::size_t{bytes[at + 2]} << 8 | bytes[at + 3]);
    } else {
      break;
    }
  }
  fail(where, "JPEG is cut short (" + std::to_string(bytes.size()) + " bytes)");
}

}  // namespace chandelier::baker
