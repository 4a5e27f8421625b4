// SPDX-License-Identifier: Apache-2.0
// The codecs: what comes back is what went in, bit for bit, and damage is refused or gives other records.
#include "pack_codec.h"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <random>

#include "pack_columns.h"
#include "pack_sample.h"
#include "pack_triangles.h"

namespace chandelier::pack::test {
namespace {

using Bytes = std::vector<std::byte>;

template <typename T>
std::span<const std::byte> bytes_of(const std::vector<T>& values) {
  return std::as_bytes(std::span(values));
}

void expect_same(const View& a, const View& b) {
  for (size_t i = 0; i < section_infos.size(); ++i) {
    const auto x = section_bytes(a, i), y = section_bytes(b, i);
    ASSERT_EQ(x.size(), y.size()) << section_infos[i].name;
    EXPECT_TRUE(x.empty() || std::memcmp(x.data(), y.data(), x.size()) == 0) << section_infos[i].name;
  }
}

TEST(PackCodec, APackComesBackBitForBitAndSmaller) {
  const Folder folder;
  const Contents contents = sheet(300);
  write(folder / "raw.pack", contents);
  write(folder / "small.pack", contents, Compression::smallest);
  const File file(folder / "small.pack");
  expect_same(file.view(), view_of(contents));
  EXPECT_LT(file.size_bytes() * 8, std::filesystem::file_size(folder / "raw.pack"));
  std::vector<Codec> codecs;
  for (const SectionEntry& entry : file.table()) codecs.push_back(entry.codec);
  EXPECT_EQ(codecs, (std::vector<Codec>{Codec::columns, Codec::columns, Codec::columns, Codec::triangles}));
}

// More than one frame a section: ten million bytes of positions and twenty of corners, in chunks of eight.
TEST(PackCodec, LongSectionsComeBack) {
  Contents contents = sheet(900);
  contents.vertex_attributes.clear();
  const View view = view_of(contents);
  const std::vector<Encoded> encoded = encode_sections(view);
  for (size_t info = 2; info < section_infos.size(); ++info) {
    const std::span<const std::byte> records = section_bytes(view, info);
    if (records.empty()) continue;
    ASSERT_EQ(encoded[info].codec,
              records.data() == bytes_of(contents.positions).data() ? Codec::columns : Codec::triangles);
    Bytes decoded(records.size());
    const Coded coded{encoded[info].codec, section_infos[info].stride_bytes, encoded[info].bytes, decoded};
    EXPECT_EQ(decode_all({&coded, 1}).front(), "");
    EXPECT_EQ(std::memcmp(decoded.data(), records.data(), records.size()), 0);
  }
}

TEST(PackCodec, SamePackSameBytes) {
  const Folder folder;
  write(folder / "a.pack", sheet(100), Compression::smallest);
  write(folder / "b.pack", sheet(100), Compression::smallest);
  EXPECT_EQ(read_file(folder / "a.pack"), read_file(folder / "b.pack"));
}

// What cannot get smaller is stored as it is, and a pack is never larger than without codecs.
TEST(PackCodec, NoiseStaysRaw) {
  const Folder folder;
  Contents contents = sample();
  std::mt19937 random(4);
  for (int i = 0; i < 100000; ++i) contents.strings.push_back(static_cast<std::byte>(random()));
  write(folder / "raw.pack", contents);
  write(folder / "small.pack", contents, Compression::smallest);
  const File file(folder / "small.pack");
  for (const SectionEntry& entry : file.table()) {
    const bool noise = entry.kind == static_cast<uint32_t>(Section::strings);
    EXPECT_TRUE(!noise || entry.codec == Codec::raw);
  }
  EXPECT_LE(std::filesystem::file_size(folder / "small.pack"), std::filesystem::file_size(folder / "raw.pack"));
}

// What zstd makes too small for a reader to trust is filled up.
TEST(PackCodec, NothingAtAllIsStoredLargeEnoughToBeOpened) {
  const Folder folder;
  Contents contents = sheet(2);
  contents.strings.resize(50'000'000);
  write(folder / "a.pack", contents, Compression::smallest);
  EXPECT_GE(std::filesystem::file_size(folder / "a.pack"), 50'000'000u / max_decode_ratio);
  EXPECT_LT(std::filesystem::file_size(folder / "a.pack"), 60'000u);
  expect_same(File(folder / "a.pack").view(), view_of(contents));
}

class EveryLayout : public testing::TestWithParam<Layout> {};
INSTANTIATE_TEST_SUITE_P(Each, EveryLayout, testing::Values(Layout::records, Layout::planes, Layout::delta_planes));

TEST_P(EveryLayout, AnyFloatsComeBackBitForBit) {
  const float inf = std::numeric_limits<float>::infinity();
  const std::vector<std::vector<float>> columns = {{0, 0, 0, 0},
                                                   {0.5f, -0.25f, 1024, 0},          // multiples of 2^-2
                                                   {0.5f, -0.0f, 1, 2},              // a zero with a sign
                                                   {1e-40f, 1, 2, 3},                // a denormal
                                                   {1e30f, 1e-30f, 1, -1},           // too far apart for integers
                                                   {inf, -inf, std::nanf("1"), 1},   // not finite
                                                   {3e38f, -3e38f, 2e38f, 1.7e38f},  // the largest
                                                   {2147483648.0f, 1, 0, 0},         // one too many for 31 bits
                                                   {-2147483520.0f, 2147483520.0f, 128, 0}};  // differences that wrap
  std::vector<float> records;
  for (size_t row = 0; row < 4; ++row) {
    for (const std::vector<float>& column : columns) records.push_back(column[row]);
  }
  const size_t stride = 4 * columns.size();
  const Bytes coded = to_columns(bytes_of(records), stride, Layouts(columns.size(), GetParam()));
  EXPECT_EQ(coded.size(), columns_bytes(4 * records.size(), stride));
  std::vector<float> back(records.size());
  ASSERT_TRUE(from_columns(coded, stride, std::as_writable_bytes(std::span(back))));
  EXPECT_EQ(std::memcmp(back.data(), records.data(), 4 * records.size()), 0);
}

TEST(PackCodec, AnyTrianglesComeBackAsTheyWereTurned) {
  std::mt19937 random(5);
  for (int round = 0; round < 300; ++round) {
    std::vector<uint32_t> corners(3 * (random() % 200));
    const uint32_t range = round % 3 == 0 ? 5 : round % 3 == 1 ? 1000 : 0xffffffffu;
    for (uint32_t& corner : corners) corner = static_cast<uint32_t>(random()) % range;
    if (corners.empty()) corners = {0xffffffffu, 0, 0xffffffffu};
    const Bytes coded = to_triangle_code(corners, static_cast<uint32_t>(random()));
    EXPECT_LE(coded.size(), triangle_code_bound(corners.size()));
    std::vector<uint32_t> back(corners.size());
    ASSERT_TRUE(from_triangle_code(coded, back));
    ASSERT_EQ(back, corners) << "round " << round;
  }
}

// Below the checksums and zstd: each decoder alone on damaged codes. A sanitizer sees it if one reads or writes astray.
TEST(PackCodec, DamagedCodesAreRefusedOrGiveOtherRecords) {
  const Contents contents = sheet(40);
  const auto positions = bytes_of(contents.positions);
  const std::span corners(reinterpret_cast<const uint32_t*>(contents.indices.data()), contents.indices.size());
  const Bytes columns = to_columns(positions, 12, {Layout::records, Layout::planes, Layout::delta_planes});
  const Bytes triangles = to_triangle_code(corners, 0);
  std::mt19937 random(6);
  int refused = 0;
  for (int round = 0; round < 10000; ++round) {
    const auto damage = [&](Bytes coded, size_t head) {
      coded[random() % (round % 2 ? head : coded.size())] = static_cast<std::byte>(random());
      if (round % 5 == 0) coded.resize(random() % coded.size());
      return coded;
    };
    Bytes records(positions.size());
    std::vector<uint32_t> some(corners.size());
    refused += !from_columns(damage(columns, 12), 12, records);
    refused += !from_triangle_code(damage(triangles, 4 + corners.size() / 3 + 16), some);
  }
  EXPECT_GT(refused, 2000);
}

// Frames, with the declared sizes of the records left alone.
TEST(PackCodec, DamagedFramesAreRefusedOrGiveOtherRecords) {
  const Contents contents = sheet(40);
  const std::vector<Encoded> encoded = encode_sections(view_of(contents));
  std::mt19937 random(7);
  int refused = 0;
  for (int round = 0; round < 10000; ++round) {
    const size_t info = 2 + static_cast<size_t>(round % 3);
    ASSERT_NE(encoded[info].codec, Codec::raw);
    Bytes stored = encoded[info].bytes, decoded(section_bytes(view_of(contents), info).size());
    stored[random() % stored.size()] = static_cast<std::byte>(random());
    if (round % 5 == 0) stored.resize(1 + random() % stored.size());
    const Coded coded{encoded[info].codec, section_infos[info].stride_bytes, stored, decoded};
    refused += !decode_all({&coded, 1}).front().empty();
  }
  EXPECT_GT(refused, 2000);
}

}  // namespace
}  // namespace chandelier::pack::test
