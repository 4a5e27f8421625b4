// SPDX-License-Identifier: Apache-2.0
// Images with a codec each: what comes back is what went in, image by image; damage is refused by name.
#include "pack_images.h"

#include <gtest/gtest.h>

#include <cstddef>
#include <cstring>
#include <functional>
#include <random>

#include "image_format.h"
#include "pack_checks.h"
#include "pack_codec.h"
#include "pack_sample.h"

namespace chandelier::pack::test {
namespace {

using Bytes = std::vector<std::byte>;

void add_image(Contents& c, ImageFormat format, uint32_t side, std::string_view name, const Bytes& texels) {
  c.image_data.resize((c.image_data.size() + 15) / 16 * 16);
  c.images.push_back({.first_byte = c.image_data.size(),
                      .stored_bytes = texels.size(),
                      .size_bytes = texels.size(),
                      .width = side,
                      .height = side,
                      .level_count = 1,
                      .format = format,
                      .name = add_string(c, name)});
  c.image_data.insert(c.image_data.end(), texels.begin(), texels.end());
}

Bytes noise(size_t size, unsigned seed) {
  std::mt19937 random(seed);
  Bytes bytes(size);
  for (std::byte& byte : bytes) byte = static_cast<std::byte>(random());
  return bytes;
}

/// Half floats from 1 on.
Bytes ramp(size_t size) {
  Bytes bytes(size, std::byte{0x3C});
  for (size_t i = 0; i < size; i += 2) bytes[i] = static_cast<std::byte>(i / 64);
  return bytes;
}

/// Noise, which no codec makes smaller, between images that get much smaller; the last has more than one frame.
Contents four_images() {
  Contents c;
  c.bake_info.batch_triangles = 1;
  add_image(c, ImageFormat::rgba16_sfloat, 32, "sky.exr", ramp(32 * 32 * 8));
  add_image(c, ImageFormat::rgba8_srgb, 64, "noise.png", noise(64 * 64 * 4, 1));
  add_image(c, ImageFormat::rgba8_unorm, 32, "black.png", Bytes(32 * 32 * 4));
  add_image(c, ImageFormat::rgba8_unorm, 2048, "large.png", ramp(size_t{2048} * 2048 * 4));
  return c;
}

Bytes raw_texels(const Contents& c, size_t i) {
  const auto first = c.image_data.begin() + static_cast<ptrdiff_t>(c.images[i].first_byte);
  return {first, first + static_cast<ptrdiff_t>(c.images[i].size_bytes)};
}

bool same(std::span<const std::byte> a, std::span<const std::byte> b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size()) == 0;
}

std::string error_of(const View& view, uint32_t image) {
  try {
    texels_of(view, image);
    return {};
  } catch (const Error& error) {
    return error.what();
  }
}

TEST(PackImages, EachComesBackWithTheCodecThatPays) {
  const Folder folder;
  const Contents contents = four_images();
  write(folder / "raw.pack", contents);
  write(folder / "small.pack", contents, Compression::smallest);
  const File raw(folder / "raw.pack"), small(folder / "small.pack");
  const ImageCodec expected[] = {ImageCodec::zstd, ImageCodec::raw, ImageCodec::zstd, ImageCodec::zstd};
  for (uint32_t i = 0; i < 4; ++i) {
    EXPECT_EQ(raw.view().images[i].codec, ImageCodec::raw);
    EXPECT_EQ(small.view().images[i].codec, expected[i]) << i;
    EXPECT_TRUE(same(texels_of(raw.view(), i).bytes(), raw_texels(contents, i))) << i;
    EXPECT_TRUE(same(texels_of(small.view(), i).bytes(), raw_texels(contents, i))) << i;
    EXPECT_EQ(small.view().images[i].size_bytes, contents.images[i].size_bytes);
  }
  const std::vector<Texels> two = texels_of(small.view(), 2, 2);
  ASSERT_EQ(two.size(), 2u);
  EXPECT_TRUE(same(two[0].bytes(), raw_texels(contents, 2)));
  EXPECT_TRUE(same(two[1].bytes(), raw_texels(contents, 3)));
  // Raw texels are where the pack has them; nothing is copied.
  EXPECT_EQ(texels_of(small.view(), 1).bytes().data(),
            small.view().image_data.data() + small.view().images[1].first_byte);
  for (const SectionEntry& entry : small.table()) {
    EXPECT_TRUE(entry.kind != static_cast<uint32_t>(Section::image_data) || entry.codec == Codec::raw);
  }
  EXPECT_LT(small.size_bytes() * 50, raw.size_bytes());
}

TEST(PackImages, SameBytesWhateverTheThreads) {
  const Folder folder;
  const Contents contents = four_images();
  for (const size_t threads : {1, 2, 7}) {
    write(folder / std::to_string(threads), view_of(contents), Sync::no, Compression::smallest, threads);
    EXPECT_EQ(read_file(folder / std::to_string(threads)), read_file(folder / "1"));
  }
}

// A pack that is compressed can be written again, with or without codecs: images keep theirs.
TEST(PackImages, CodedImagesStayAsTheyAre) {
  const Folder folder;
  write(folder / "a", four_images(), Compression::smallest);
  const File first(folder / "a");
  write(folder / "b", first.view(), Sync::no, Compression::smallest);
  write(folder / "c", first.view(), Sync::no);
  EXPECT_EQ(read_file(folder / "a"), read_file(folder / "b"));
  const File raw_sections(folder / "c");
  for (uint32_t i = 0; i < 4; ++i) {
    EXPECT_EQ(raw_sections.view().images[i].codec, first.view().images[i].codec);
    EXPECT_TRUE(same(texels_of(raw_sections.view(), i).bytes(), texels_of(first.view(), i).bytes()));
  }
}

// Opening a pack decodes no image: those that are not asked for cost nothing, and a damaged one spoils itself alone.
TEST(PackImages, OneDamagedImageIsRefusedByNameAndTheOthersStay) {
  const Folder folder;
  write(folder / "a", four_images(), Compression::smallest);
  const File file(folder / "a");
  Contents damaged = four_images();
  damaged.images.assign(file.view().images.begin(), file.view().images.end());
  damaged.image_data.assign(file.view().image_data.begin(), file.view().image_data.end());
  damaged.image_data[damaged.images[2].first_byte] ^= std::byte{0xFF};  // the frame's magic
  write(folder / "b", damaged);
  const File opened(folder / "b");
  EXPECT_TRUE(error_of(opened.view(), 2).starts_with("images[2] (black.png).codec: zstd: "))
      << error_of(opened.view(), 2);
  for (const uint32_t good : {0u, 1u, 3u}) EXPECT_EQ(error_of(opened.view(), good), "");
  EXPECT_THROW(check_images(opened.view()), Error);
  EXPECT_NO_THROW(check_images(file.view()));
}

/// The first image as zstd of other texels than the pack's; its sizes as `change` has them.
std::string error_with(const Bytes& texels, const std::function<void(Image&, Bytes&)>& change) {
  const std::span<const std::byte> span = texels;
  Contents c;
  c.bake_info.batch_triangles = 1;
  add_image(c, ImageFormat::rgba16_sfloat, 32, "sky.exr", Bytes(32 * 32 * 8));
  Bytes stored = encode_images({&span, 1}).front().bytes;
  EXPECT_FALSE(stored.empty());
  change(c.images[0], stored);
  c.images[0].codec = ImageCodec::zstd;
  c.images[0].stored_bytes = stored.size();
  c.image_data = stored;
  EXPECT_EQ(check(view_of(c)), "");
  return error_of(view_of(c), 0);
}

TEST(PackImages, FramesOfOtherTexelsAreRefused) {
  const auto nothing = [](Image&, Bytes&) {};
  const std::string start = "images[0] (sky.exr)";
  EXPECT_EQ(error_with(ramp(32 * 32 * 8), nothing), "");
  EXPECT_EQ(error_with(ramp(32 * 32 * 8 - 16), nothing), start + ".codec: zstd: a frame of a wrong size");
  EXPECT_EQ(error_with(ramp(32 * 32 * 8 + 16), nothing), start + ".codec: zstd: a frame of a wrong size");
  EXPECT_EQ(error_with(ramp(32 * 32 * 8), [](Image&, Bytes& stored) { stored.push_back(std::byte{1}); }),
            start + ".codec: zstd: bytes after the last frame");
  Bytes infinite = ramp(32 * 32 * 8);
  infinite[101] = std::byte{0x7C};
  infinite[100] = std::byte{0};
  EXPECT_EQ(error_with(infinite, nothing), start + ": half float 50 is negative or not finite (31744)");
}

TEST(PackImages, EveryTruncationOfAnImageIsRefused) {
  for (size_t cut = 1; cut < 60; ++cut) {
    const std::string error = error_with(ramp(32 * 32 * 8), [&](Image&, Bytes& stored) {
      stored.resize(cut < stored.size() - 8 ? stored.size() - cut : 8);
    });
    EXPECT_NE(error, "") << cut;
  }
}

// Flips in frames and in records behind right checksums. A sanitizer sees it if one leads astray.
TEST(PackImages, FlipsAreRefusedOrGiveOtherTexels) {
  Contents contents;
  contents.bake_info.batch_triangles = 1;
  add_image(contents, ImageFormat::rgba16_sfloat, 8, "sky.exr", ramp(8 * 8 * 8));
  add_image(contents, ImageFormat::rgba8_unorm, 16, "b", ramp(16 * 16 * 4));
  const EncodedImages encoded = encode_images(view_of(contents));
  ASSERT_EQ(encoded.images[1].codec, ImageCodec::zstd);
  std::mt19937 random(9);
  int refused_at_once = 0, refused_later = 0, other = 0;
  for (int round = 0; round < 20000; ++round) {
    Contents changed = contents;
    changed.images = encoded.images;
    changed.image_data = encoded.image_data;
    const auto records = std::as_writable_bytes(std::span(changed.images));
    std::byte& byte =
        round % 2 ? records[random() % records.size()] : changed.image_data[random() % changed.image_data.size()];
    byte ^= static_cast<std::byte>(1 << random() % 8);
    if (!check(view_of(changed)).empty()) {
      ++refused_at_once;
      continue;
    }
    for (uint32_t i = 0; i < 2; ++i) {
      if (!error_of(view_of(changed), i).empty()) {
        ++refused_later;
      } else {
        EXPECT_EQ(texels_of(view_of(changed), i).bytes().size(), image_bytes(changed.images[i]));
        ++other;
      }
    }
  }
  EXPECT_GT(refused_at_once, 3000);
  EXPECT_GT(refused_later, 1000);
  EXPECT_GT(other, 1000);
}

// Fields that no check has seen: nothing is encoded, nothing is read astray.
TEST(PackImages, ImagesOutsideTheirSectionAreWrittenAsTheyAre) {
  for (const uint64_t first : {uint64_t{1} << 62, ~uint64_t{15}, uint64_t{1} << 20}) {
    Contents contents = sample();
    contents.images[1].first_byte = first;
    EXPECT_TRUE(encode_images(view_of(contents)).images.empty());
    const Folder folder;
    write(folder / "a", contents, Compression::smallest);
    EXPECT_NE(open_error(folder / "a"), "");
  }
}

}  // namespace
}  // namespace chandelier::pack::test
