// SPDX-License-Identifier: Apache-2.0
// What chandelier-bake and its module for images, chandelier_images.so, say to each other. The module alone knows
// OpenImageIO, whose 250 libraries take longer to load than a small bake.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace chandelier::baker {

struct DecodedImage {
  std::int64_t width = 0, height = 0;
  int channels = 0;
  std::vector<std::uint8_t> values;  // as stored: rows from the top, not premultiplied
  std::string fault;                 // what is wrong, in OpenImageIO's words; or nothing
};

/// Of a whole PNG or JPEG file. There are no values where a side is not 1 to `max_size` or channels are not 1 to 4.
using DecodeFunction = DecodedImage (*)(const std::vector<std::uint8_t>& file, bool is_png, std::int64_t max_size);

/// The only thing that the module exports: a DecodeFunction under this name.
inline constexpr const char* decode_symbol = "chandelier_decode_image";

}  // namespace chandelier::baker
