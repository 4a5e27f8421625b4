// SPDX-License-Identifier: Apache-2.0
// The codecs of sections and images. What is coded is a row of zstd frames, one for each codec_chunk_bytes of records.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "pack_schema.h"

namespace chandelier::pack {

/// Codecs save at least a twentieth, or what they code stays raw.
struct Encoded {
  Codec codec = Codec::raw;
  std::vector<std::byte> bytes;  ///< Empty for Codec::raw: what is stored are the section's own bytes.
};

/// Encodes each section of section_infos with the codec that is best on a sample of it; those that are always raw not.
/// The same view gives the same bytes, whatever the number of threads; 0: all cores.
std::vector<Encoded> encode_sections(const View& view, size_t most_threads = 0);

/// Encodes each of `images` by zstd, like encode_sections().
std::vector<Encoded> encode_images(std::span<const std::span<const std::byte>> images, size_t most_threads = 0);

/// A section or an image that is stored with a codec, and where its records go; an image's are its bytes.
struct Coded {
  Codec codec;
  uint32_t stride_bytes;
  std::span<const std::byte> stored;
  std::span<std::byte> records;  ///< Its size is a multiple of the stride; aligned for the records.
};

/// Are `count` records more than so many stored bytes can hold?
constexpr bool are_too_many(uint64_t count, uint32_t stride_bytes, uint64_t stored_bytes) {
  return count / max_decode_ratio > stored_bytes / stride_bytes + 1;
}

/// The fault of the codec or of the sizes, which are not trusted; an empty string if decoding can be tried. Refuses
/// records of more than about max_decode_ratio times the stored bytes, so a file's size limits what it can ask for: 10
/// MB may ask for 10 GB, as valid sections of zeros do.
std::string coded_size_fault(Codec codec, uint32_t stride_bytes, uint64_t stored_bytes, uint64_t count);

/// Decodes all; none is raw and all passed coded_size_fault(). Gives for each what is wrong with it or an empty string.
std::vector<std::string> decode_all(std::span<const Coded> coded, size_t most_threads = 0);

}  // namespace chandelier::pack
