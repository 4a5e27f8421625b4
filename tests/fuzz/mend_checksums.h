// SPDX-License-Identifier: Apache-2.0
// Makes a pack's checksums right, so that what lies behind them is reached.
#pragma once

#define XXH_INLINE_ALL
#include <xxhash.h>

#include <cstdint>
#include <cstring>
#include <vector>

#include "pack_schema.h"

namespace chandelier::fuzz {

inline void mend_checksums(std::vector<uint8_t>& bytes) {
  pack::FileHeader header;
  if (bytes.size() < sizeof(header)) return;
  std::memcpy(&header, bytes.data(), sizeof(header));
  std::memcpy(header.magic.data(), pack::magic.data(), header.magic.size());
  header.version = pack::schema_version;
  header.schema_hash = pack::schema_hash;
  header.file_bytes = bytes.size();
  const uint64_t table_bytes = uint64_t{header.section_count} * sizeof(pack::SectionEntry);
  if (table_bytes <= bytes.size() - sizeof(header)) {
    for (uint32_t i = 0; i < header.section_count; ++i) {
      uint8_t* place = bytes.data() + sizeof(header) + i * sizeof(pack::SectionEntry);
      pack::SectionEntry entry;
      std::memcpy(&entry, place, sizeof(entry));
      if (entry.offset_bytes > bytes.size() || entry.size_bytes > bytes.size() - entry.offset_bytes) continue;
      entry.checksum = XXH3_64bits(bytes.data() + entry.offset_bytes, entry.size_bytes);
      std::memcpy(place, &entry, sizeof(entry));
    }
    header.table_checksum = XXH3_64bits(bytes.data() + sizeof(header), table_bytes);
  }
  std::memcpy(bytes.data(), &header, sizeof(header));
}

}  // namespace chandelier::fuzz
