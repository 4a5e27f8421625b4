// SPDX-License-Identifier: Apache-2.0
// Headers and tables that lie, with right checksums: each lie is named.
#define XXH_INLINE_ALL
#include <gtest/gtest.h>
#include <xxhash.h>

#include <cstddef>
#include <cstring>
#include <functional>

#include "pack_sample.h"

namespace chandelier::pack::test {
namespace {

/// A pack taken apart, to be changed and put together again.
struct Parts {
  FileHeader header;
  std::vector<SectionEntry> table;
  std::vector<char> rest;  ///< What follows the table.
};

Parts take_apart(const std::vector<char>& bytes) {
  Parts parts;
  std::memcpy(&parts.header, bytes.data(), sizeof(FileHeader));
  parts.table.resize(parts.header.section_count);
  const size_t table_bytes = parts.table.size() * sizeof(SectionEntry);
  std::memcpy(parts.table.data(), bytes.data() + sizeof(FileHeader), table_bytes);
  parts.rest.assign(bytes.begin() + static_cast<ptrdiff_t>(sizeof(FileHeader) + table_bytes), bytes.end());
  return parts;
}

std::vector<char> put_together(const Parts& parts) {
  std::vector<char> bytes(sizeof(FileHeader) + parts.table.size() * sizeof(SectionEntry));
  std::memcpy(bytes.data(), &parts.header, sizeof(FileHeader));
  std::memcpy(bytes.data() + sizeof(FileHeader), parts.table.data(), parts.table.size() * sizeof(SectionEntry));
  bytes.insert(bytes.end(), parts.rest.begin(), parts.rest.end());
  return bytes;
}

struct Lie {
  const char* name;
  std::function<void(Parts&)> corrupt;
  const char* error;
};

void PrintTo(const Lie& lie, std::ostream* out) {
  *out << lie.name;
}

constexpr uint64_t huge = uint64_t{1} << 63;

// Table: 0 bake_info, 1 strings, 2 positions (7 of 12 bytes), …, 36 skin_vertices: all of them.
constexpr size_t last = section_infos.size() - 1;
const Lie lies[] = {
    {"OlderVersion", [](Parts& p) { p.header.version = 1; },
     "a pack of an older chandelier-bake: bake it again (version 1, "},
    {"NewerVersion", [](Parts& p) { ++p.header.version; },
     "a pack of a newer chandelier-bake: show it with the programs that"},
    {"Layout", [](Parts& p) { p.header.schema_hash = 5; },
     "a pack of another build of chandelier-bake, whose layout is"},
    {"FileSize", [](Parts& p) { --p.header.file_bytes; }, "header.file_bytes: "},
    {"TooManySections", [](Parts& p) { p.header.section_count = 257; }, "header.section_count: 257 is above 256"},
    {"SectionsPastTheEnd", [](Parts& p) { p.header.section_count = 256; }, "header.section_count: 256 do not fit"},
    {"FewerSections", [](Parts& p) { p.header.section_count = last; }, "header.table_checksum: "},
    {"TableChecksum", [](Parts& p) { ++p.header.table_checksum; }, "header.table_checksum: "},
    {"UnknownKind", [](Parts& p) { p.table[last].kind = last + 2; }, "table[36].kind: unknown, or not above"},
    {"KindZero", [](Parts& p) { p.table[0].kind = 0; }, "table[0].kind: unknown, or not above"},
    {"KindTwice", [](Parts& p) { p.table[3].kind = 3; }, "table[3].kind: unknown, or not above"},
    {"KindsDescend", [](Parts& p) { std::swap(p.table[2], p.table[3]); }, "table[2].offset_bytes: "},
    {"Codec", [](Parts& p) { p.table[2].codec = Codec{4}; }, "table[2].codec: 4 is no Codec (section positions)"},
    {"NotCompressed", [](Parts& p) { p.table[2].codec = Codec::zstd; },
     "table[2].codec: zstd: Unknown frame descriptor (section positions)"},
    {"CodecOfTriangles", [](Parts& p) { p.table[2].codec = Codec::triangles; },
     "table[2].codec: triangles is not for such records (section positions)"},
    {"CodecOfWords", [](Parts& p) { p.table[1].codec = Codec::columns; },
     "table[1].codec: columns is not for such records (section strings)"},
    {"DecodedSize",
     [](Parts& p) {
       p.table[2].codec = Codec::columns;
       p.table[2].count = uint64_t{1} << 40;
     },
     "table[2].count: 1099511627776 records of 12 bytes are too many for the stored 84 (section positions)"},
    {"Reserved", [](Parts& p) { p.table[2].reserved = 1; }, "table[2].reserved: 1 where 0 must be"},
    {"Stride", [](Parts& p) { p.table[2].stride_bytes = 16; }, "table[2].stride_bytes: 16 where 12 must be"},
    {"StrideZero", [](Parts& p) { p.table[2].stride_bytes = 0; }, "table[2].stride_bytes: 0 where 12 must be"},
    {"OffsetNotAligned", [](Parts& p) { ++p.table[2].offset_bytes; }, "table[2].offset_bytes: "},
    {"OffsetOverlaps", [](Parts& p) { p.table[2].offset_bytes -= 256; }, "table[2].offset_bytes: "},
    {"OffsetLeavesAGap", [](Parts& p) { p.table[2].offset_bytes += 256; }, "table[2].offset_bytes: "},
    {"OffsetHuge", [](Parts& p) { p.table[2].offset_bytes = ~uint64_t{255}; }, "table[2].offset_bytes: "},
    {"SizePastTheEnd", [](Parts& p) { p.table[last].size_bytes += 16; }, "table[36].size_bytes: "},
    {"SizeWraps", [](Parts& p) { p.table[2].size_bytes = ~uint64_t{11}; }, "table[2].size_bytes: "},
    {"SizeZero", [](Parts& p) { p.table[2].size_bytes = p.table[2].count = 0; },
     "table[2].size_bytes: 0 where 12 must"},
    {"Count", [](Parts& p) { p.table[2].count = 5; }, "table[2].count: 5 of 12 bytes are not the size 84"},
    {"CountWraps", [](Parts& p) { p.table[4].count += huge; },
     "table[4].count: "},  // 4 bytes each: 2^63 · 4 wraps to 0
    {"SizeNoMultiple", [](Parts& p) { --p.table[2].size_bytes; }, "table[2].count: 7 of 12 bytes are not the size 83"},
    {"Checksum", [](Parts& p) { ++p.table[2].checksum; }, "table[2].checksum: "},
    {"TwoBakeInfos",
     [](Parts& p) {
       p.table[0].count = 2;
       p.table[0].size_bytes *= 2;
       const size_t rest_start = sizeof(FileHeader) + p.table.size() * sizeof(SectionEntry);
       p.table[0].checksum = XXH3_64bits(&p.rest[p.table[0].offset_bytes - rest_start], p.table[0].size_bytes);
     },
     "bake_info: not exactly 1 record"},
    {"PaddingNotZero", [](Parts& p) { p.rest[0] = 1; }, "table[0].offset_bytes: the bytes before it are not zero"},
    {"NoBakeInfo",
     [](Parts& p) {
       p.table.clear();
       p.rest.clear();
       p.header.section_count = 0;
       p.header.file_bytes = sizeof(FileHeader);
     },
     "bake_info: not exactly 1 record"},
    {"BytesAfterTheEnd",
     [](Parts& p) {
       p.rest.push_back(0);
       ++p.header.file_bytes;
     },
     "bytes after the last section (1)"},
};

class PackTable : public testing::TestWithParam<Lie> {};

TEST_P(PackTable, LieIsNamed) {
  const Folder folder;
  write(folder / "a.pack", sample());
  Parts parts = take_apart(read_file(folder / "a.pack"));
  const uint64_t checksum = parts.header.table_checksum;
  GetParam().corrupt(parts);
  if (parts.header.table_checksum == checksum && parts.header.section_count == parts.table.size()) {
    parts.header.table_checksum = XXH3_64bits(parts.table.data(), parts.table.size() * sizeof(SectionEntry));
  }
  write_file(folder / "a.pack", put_together(parts));
  const std::string error = open_error(folder / "a.pack");
  EXPECT_EQ(error.find(GetParam().error), 0u) << error;
}

INSTANTIATE_TEST_SUITE_P(Each, PackTable, testing::ValuesIn(lies), [](const auto& each) { return each.param.name; });

}  // namespace
}  // namespace chandelier::pack::test
