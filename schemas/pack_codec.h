// SPDX-License-Identifier: Apache-2.0
// The sections' codecs. A coded section is a row of zstd frames, one for each codec_chunk_bytes of its records.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "pack_schema.h"

namespace chandelier::pack {

struct Encoded {
  Codec codec = Codec::raw;
  std::vector<std::byte> bytes;  ///< Empty for Codec::raw: what is stored are the section's own bytes.
};

/// Encodes each section of section_infos with the codec that is best on a sample of it; raw if that saves less than a
/// twentieth. The same view gives the same bytes, whatever the number of threads; 0: all cores.
std::vector<Encoded> encode_sections(const View& view, std::size_t most_threads = 0);

/// One section that is stored with a codec, and where its records go.
struct CodedSection {
  Codec codec;
  std::uint32_t stride_bytes;
  std::span<const std::byte> stored;
  std::span<std::byte> records;  ///< Its size is a multiple of the stride; aligned for the records.
};

/// The fault of the codec or of the sizes, which are not trusted; an empty string if decoding can be tried. Refuses
/// records of more than about max_decode_ratio times the stored bytes, so a file's size limits what it can ask for: 10
/// MB may ask for 10 GB, as valid sections of zeros do.
std::string coded_size_fault(Codec codec, std::uint32_t stride_bytes, std::uint64_t stored_bytes, std::uint64_t count);

/// Decodes all; none is raw and all passed coded_size_fault(). Gives for each what is wrong with it or an empty string.
std::vector<std::string> decode_sections(std::span<const CodedSection> sections, std::size_t most_threads = 0);

}  // namespace chandelier::pack
