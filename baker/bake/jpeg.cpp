// SPDX-License-Identifier: Apache-2.0
// JPEG (ITU-T T.81, Annex B) as a sequence of marker segments. The check is needed since a decoder fills missing parts
// with grey and reports nothing.
#include "jpeg.h"

namespace chandelier::baker {
namespace {

constexpr uint8_t end_of_image = 0xD9, first_restart = 0xD0, start_of_image = 0xD8, temporary = 0x01;

/// Markers without a length of their own.
bool stands_alone(uint8_t marker) {
  return (marker >= first_restart && marker <= start_of_image) || marker == temporary;
}

/// Table B.1: SOF0 to SOF15; three numbers in between are other markers.
bool starts_frame(uint8_t marker) {
  return marker >= 0xC0 && marker <= 0xCF && marker != 0xC4 && marker != 0xC8 && marker != 0xCC;
}

size_t u16_at(const uint8_t* bytes) {
  return size_t{bytes[0]} << 8 | bytes[1];
}

/// The position of the first marker for which `wanted` holds, among those with a length and the end marker; the size of
/// `bytes` if there is none.
template <typename Wanted>
size_t find_marker(const std::vector<uint8_t>& bytes, Wanted wanted) {
  // Between segments lie the scans' data, in which FF is followed by 00, or by more FF before a marker.
  for (size_t at = 0; at + 1 < bytes.size();) {
    const uint8_t marker = bytes[at + 1];
    if (bytes[at] != 0xFF || marker == 0xFF) {
      ++at;
    } else if (marker == 0 || stands_alone(marker)) {
      at += 2;
    } else if (wanted(marker)) {
      return at;
    } else if (marker != end_of_image && at + 3 < bytes.size()) {
      at += 2 + u16_at(&bytes[at + 2]);
    } else {
      break;
    }
  }
  return bytes.size();
}

}  // namespace

bool is_whole_jpeg(const std::vector<uint8_t>& bytes) {
  return find_marker(bytes, [](uint8_t marker) { return marker == end_of_image; }) < bytes.size();
}

ClaimedSize jpeg_size(const std::vector<uint8_t>& bytes) {
  const size_t at = find_marker(bytes, starts_frame);
  if (bytes.size() - at < 9) return {};
  return {u16_at(&bytes[at + 7]), u16_at(&bytes[at + 5])};  // marker, length, precision, height, width
}

}  // namespace chandelier::baker
