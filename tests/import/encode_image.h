// SPDX-License-Identifier: Apache-2.0
// Image files made in tests, by OpenImageIO.
#pragma once

#include <cstdint>
#include <vector>

#include "scene.h"

namespace chandelier::baker::test {

/// `extension`: "png", "jpg" or "webp". Pixels are rows from the top, not premultiplied.
EncodedImage encoded(const char* extension, int width, int height, int channels, const std::vector<uint8_t>& pixels);

/// Bytes that do not compress.
std::vector<uint8_t> noise(size_t count);

/// What decode_image throws: the error's line, or "" where it passes.
std::string decode_error(const EncodedImage& image);

}  // namespace chandelier::baker::test
