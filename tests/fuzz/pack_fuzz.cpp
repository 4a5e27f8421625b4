// SPDX-License-Identifier: Apache-2.0
// Any bytes as a pack: opened and read in full, or refused with pack::Error. Checksums are made right first, so that
// what lies behind them is reached.
#define XXH_INLINE_ALL
#include <xxhash.h>

#include <cstring>
#include <vector>

#include "fuzz_file.h"
#include "pack_file.h"

namespace {

using namespace chandelier;

void mend_checksums(std::vector<std::uint8_t>& bytes) {
  pack::FileHeader header;
  if (bytes.size() < sizeof(header)) return;
  std::memcpy(&header, bytes.data(), sizeof(header));
  std::memcpy(header.magic.data(), pack::magic.data(), header.magic.size());
  header.version = pack::schema_version;
  header.schema_hash = pack::schema_hash;
  header.file_bytes = bytes.size();
  const std::uint64_t table_bytes = std::uint64_t{header.section_count} * sizeof(pack::SectionEntry);
  if (table_bytes <= bytes.size() - sizeof(header)) {
    for (std::uint32_t i = 0; i < header.section_count; ++i) {
      std::uint8_t* place = bytes.data() + sizeof(header) + i * sizeof(pack::SectionEntry);
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

/// Reads every byte of every section: where one is not there, the sanitizer says so.
std::uint64_t sum_of(const pack::File& file) {
  std::uint64_t sum = 0;
  for (std::size_t i = 0; i < pack::section_infos.size(); ++i) {
    for (const std::byte byte : pack::section_bytes(file.view(), i)) sum += static_cast<std::uint64_t>(byte);
  }
  for (const pack::Instance& instance : file.view().instances) sum += file.text(instance.name).size();
  return sum;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  std::vector<std::uint8_t> bytes(data, data + size);
  mend_checksums(bytes);
  const fuzz::MemoryFile file(bytes);
  try {
    const volatile std::uint64_t sum = sum_of(pack::File(file.path()));
    (void)sum;
  } catch (const pack::Error&) {
  }
  return 0;
}
