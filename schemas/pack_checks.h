// SPDX-License-Identifier: Apache-2.0
// The rules of a pack that one field alone cannot break.
#pragma once

#include <string>

#include "pack_schema.h"

namespace chandelier::pack {

/// validate() and then the rules between fields. Returns one line that names the first fault, or an empty string.
[[nodiscard]] std::string check(const View& view);

/// Bytes of all levels of an image with valid fields: `image.size_bytes` must be this.
std::uint64_t image_bytes(const Image& image);

}  // namespace chandelier::pack
