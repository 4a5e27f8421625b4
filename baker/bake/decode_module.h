// SPDX-License-Identifier: Apache-2.0
// The interface between chandelier-bake and its module for images, chandelier_images.so. Only the module uses
// OpenImageIO, whose 250 libraries take longer to load than a small bake.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace chandelier::baker {

enum class ImageFormat { png, jpeg, webp };

struct DecodedImage {
  int64_t width = 0, height = 0;
  int channels = 0;
  std::vector<uint8_t> values;  // rows from the top, as stored, not premultiplied (WebP with alpha is)
  std::string fault;            // OpenImageIO's message if there are no values, else empty
  std::string damage;           // OpenImageIO's message about damage that it tolerated, else empty
};

/// Decodes a whole file. `values` is empty if a side is not 1 to `max_size`, or if there are not 1 to 4 channels.
using DecodeFunction = DecodedImage (*)(const std::vector<uint8_t>& file, ImageFormat format, int64_t max_size);

/// The only thing that the module exports: a DecodeFunction under this name.
inline constexpr const char* decode_symbol = "chandelier_decode_image";

}  // namespace chandelier::baker
