// SPDX-License-Identifier: Apache-2.0
// The texels of a pack's images, each of which is stored with a codec of its own.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "pack_schema.h"

namespace chandelier::pack {

/// All levels of an image as they are used: borrowed from the pack where it is stored raw, else decoded.
class Texels {
 public:
  explicit Texels(std::span<const std::byte> borrowed) : bytes_(borrowed) {}
  Texels(std::unique_ptr<std::byte[]> decoded, size_t size)
      : decoded_(std::move(decoded)), bytes_(decoded_.get(), size) {}
  std::span<const std::byte> bytes() const { return bytes_; }

 private:
  std::unique_ptr<std::byte[]> decoded_;
  std::span<const std::byte> bytes_;
};

/// The texels of `count` images from `first` on, decoded in at most `most_threads` threads; 0: as many as there are
/// cores. `view` has passed check(), which does not decode images. Throws Error where what is stored is malformed, or
/// holds half floats that an image may not hold: `images[3] (sky.exr): …`.
std::vector<Texels> texels_of(const View& view, uint32_t first, uint32_t count, size_t most_threads = 0);
/// Of one image.
Texels texels_of(const View& view, uint32_t image);

/// Decodes one image after the other, and keeps none. Throws Error.
void check_images(const View& view, size_t most_threads = 0);

/// ": half float 3 is negative or not finite (31744)", or an empty string.
std::string half_float_fault(std::span<const std::byte> texels);

/// What a compressed pack has in the place of a view's images and image_data.
struct EncodedImages {
  std::vector<Image> images;
  std::vector<std::byte> image_data;
};

/// Stores each raw image with the codec that makes it smallest; those that have a codec stay. Bytes that are of no
/// image are left out. The same view gives the same bytes, whatever the number of threads. Its records need not have
/// passed any check: of images that do not lie in image_data one after the other nothing is encoded, and the result is
/// empty.
EncodedImages encode_images(const View& view, size_t most_threads = 0);

}  // namespace chandelier::pack
