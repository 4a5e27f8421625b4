// SPDX-License-Identifier: Apache-2.0
// What is written is what is read.
#include <gtest/gtest.h>

#include <cstring>
#include <utility>

#include "pack_checks.h"
#include "pack_sample.h"

namespace chandelier::pack::test {
namespace {

bool same(std::span<const std::byte> a, std::span<const std::byte> b) {
  return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), a.size()) == 0);
}

void expect_same(const View& a, const View& b) {
  for (size_t i = 0; i < section_infos.size(); ++i) {
    EXPECT_TRUE(same(section_bytes(a, i), section_bytes(b, i))) << section_infos[i].name;
  }
}

TEST(PackRoundTrip, EverySectionComesBack) {
  const Folder folder;
  const Contents contents = sample();
  ASSERT_EQ(check(view_of(contents)), "");
  for (size_t i = 0; i < section_infos.size(); ++i) {
    EXPECT_FALSE(section_bytes(view_of(contents), i).empty()) << "the sample lacks " << section_infos[i].name;
  }
  write(folder / "a.pack", contents);
  const File file(folder / "a.pack");
  expect_same(file.view(), view_of(contents));
  EXPECT_EQ(file.size_bytes(), std::filesystem::file_size(folder / "a.pack"));
  EXPECT_EQ(file.text(file.view().materials[1].name), "Blätter");
  EXPECT_EQ(file.text(file.view().bake_info->source), "hall.glb\nlamps.gltf");
  EXPECT_EQ(file.text({}), "");
}

TEST(PackRoundTrip, EmptySectionsAreLeftOut) {
  const Folder folder;
  Contents contents;
  contents.bake_info.batch_triangles = 1;
  write(folder / "a.pack", contents);
  EXPECT_EQ(std::filesystem::file_size(folder / "a.pack"), section_alignment + sizeof(BakeInfo));
  const File file(folder / "a.pack");
  expect_same(file.view(), view_of(contents));
  EXPECT_TRUE(file.view().lights.empty());
  EXPECT_EQ(file.view().bake_info->batch_triangles, 1u);
}

TEST(PackRoundTrip, SameContentsSameBytes) {
  const Folder folder;
  write(folder / "a.pack", sample());
  write(folder / "b.pack", sample());
  EXPECT_EQ(read_file(folder / "a.pack"), read_file(folder / "b.pack"));
}

TEST(PackRoundTrip, SectionsAreAligned) {
  const Folder folder;
  write(folder / "a.pack", sample());
  const File file(folder / "a.pack");
  for (size_t i = 0; i < section_infos.size(); ++i) {
    const auto address = reinterpret_cast<uintptr_t>(section_bytes(file.view(), i).data());
    EXPECT_EQ(address % section_alignment, 0u) << section_infos[i].name;
  }
}

TEST(PackRoundTrip, MovesKeepTheMapping) {
  const Folder folder;
  const Contents contents = sample();
  write(folder / "a.pack", contents);
  write(folder / "b.pack", Contents(contents));
  File first(folder / "a.pack");
  File second(std::move(first));
  expect_same(second.view(), view_of(contents));
  EXPECT_EQ(first.size_bytes(), 0u);  // NOLINT: a moved-from File is empty
  EXPECT_TRUE(first.view().positions.empty());
  File third(folder / "b.pack");
  third = std::move(second);
  expect_same(third.view(), view_of(contents));
}

TEST(PackRoundTrip, APackStaysReadableWhenItIsReplaced) {
  const Folder folder;
  Contents contents = sample();
  write(folder / "a.pack", contents);
  const File before(folder / "a.pack");
  const Contents old = contents;
  contents.cameras.clear();
  write(folder / "a.pack", contents);
  expect_same(before.view(), view_of(old));
  EXPECT_TRUE(File(folder / "a.pack").view().cameras.empty());
}

}  // namespace
}  // namespace chandelier::pack::test
