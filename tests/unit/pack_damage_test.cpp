// SPDX-License-Identifier: Apache-2.0
// A damaged file is refused with one line, whatever the damage.
#define XXH_INLINE_ALL
#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>
#include <xxhash.h>

#include <cmath>
#include <cstring>
#include <random>

#include "image_format.h"
#include "pack_images.h"
#include "pack_sample.h"

namespace chandelier::pack::test {
namespace {

/// A pack on disk whose bytes can be changed in place.
struct Target {
  Folder folder;
  std::filesystem::path path = folder / "a.pack";
  std::vector<char> bytes;
  int descriptor = -1;

  explicit Target(Compression compression = Compression::off) {
    write(path, sample(), compression);
    bytes = read_file(path);
    descriptor = ::open(path.c_str(), O_WRONLY | O_CLOEXEC);
  }
  ~Target() { ::close(descriptor); }
  void put(size_t at, char value) const { ASSERT_EQ(pwrite(descriptor, &value, 1, static_cast<off_t>(at)), 1); }
};

/// Both ways to store a pack.
class StoredPack : public testing::TestWithParam<Compression> {};
INSTANTIATE_TEST_SUITE_P(Each, StoredPack, testing::Values(Compression::off, Compression::smallest),
                         [](const auto& each) { return each.param == Compression::off ? "Raw" : "Compressed"; });

TEST_P(StoredPack, EveryTruncationIsRefused) {
  const Target target(GetParam());
  for (size_t size = target.bytes.size(); size-- > 0;) {
    ASSERT_EQ(ftruncate(target.descriptor, static_cast<off_t>(size)), 0);
    ASSERT_NE(open_error(target.path), "") << size << " bytes";
  }
}

TEST_P(StoredPack, TenThousandChangedBytesAreRefused) {
  const Target target(GetParam());
  std::mt19937 random(2);
  for (int round = 0; round < 10000; ++round) {
    const size_t at = random() % target.bytes.size();
    const int change = 1 + static_cast<int>(random() % 255);
    target.put(at, static_cast<char>(target.bytes[at] + change));
    ASSERT_NE(open_error(target.path), "") << "byte " << at << " plus " << change;
    target.put(at, target.bytes[at]);
  }
  EXPECT_EQ(open_error(target.path), "");
}

TEST(PackDamage, BytesAtTheEndAreRefused) {
  const Target target;
  target.put(target.bytes.size(), 0);
  EXPECT_NE(open_error(target.path).find("header.file_bytes"), std::string::npos);
}

// Header, table, sections and the zeros between: every byte of the file is one that something checks.
TEST(PackDamage, EveryBitCounts) {
  const Target target;
  for (size_t at = 0; at < target.bytes.size(); ++at) {
    for (int bit = 0; bit < 8; ++bit) {
      target.put(at, static_cast<char>(target.bytes[at] ^ (1 << bit)));
      ASSERT_NE(open_error(target.path), "") << "byte " << at << " bit " << bit;
    }
    target.put(at, target.bytes[at]);
  }
  EXPECT_EQ(open_error(target.path), "");
}

TEST(PackDamage, EveryByteOfHeaderAndTableCounts) {
  const Target target;
  const size_t end = sizeof(FileHeader) + section_infos.size() * sizeof(SectionEntry);
  for (size_t at = 0; at < end; ++at) {
    for (int change = 1; change < 256; change += 7) {
      target.put(at, static_cast<char>(target.bytes[at] + change));
      ASSERT_NE(open_error(target.path), "") << "byte " << at << " plus " << change;
    }
    target.put(at, target.bytes[at]);
  }
}

/// Makes checksums right where the table's entries lie within the file, as a hostile writer would.
void reseal(std::vector<char>& bytes) {
  FileHeader header;
  std::memcpy(&header, bytes.data(), sizeof(header));
  if (header.section_count > section_infos.size()) return;
  char* table = bytes.data() + sizeof(header);
  for (uint32_t i = 0; i < header.section_count; ++i) {
    SectionEntry entry;
    std::memcpy(&entry, table + i * sizeof(entry), sizeof(entry));
    if (entry.offset_bytes > bytes.size() || entry.size_bytes > bytes.size() - entry.offset_bytes) continue;
    entry.checksum = XXH3_64bits(bytes.data() + entry.offset_bytes, entry.size_bytes);
    std::memcpy(table + i * sizeof(entry), &entry, sizeof(entry));
  }
  header.table_checksum = XXH3_64bits(table, header.section_count * sizeof(SectionEntry));
  std::memcpy(bytes.data(), &header, sizeof(header));
}

double follow_draws(const File& file) {
  const View& view = file.view();
  double sum = 0;
  for (const BatchInstance& draw : view.batch_instances) {
    const Batch& batch = view.batches[draw.batch];
    sum += view.instances[draw.instance].world_from_local[0].x;
    for (uint32_t i = 0; i < batch.index_count; ++i) {
      const uint32_t vertex = view.indices[batch.first_index + i].vertex;
      sum += view.positions[vertex].position_ls.x + view.vertex_attributes[vertex].uv0.x;
    }
    const Material& material = view.materials[batch.material];
    if (material.normal_texture != none) sum += view.images[view.textures[material.normal_texture].image].width;
    for (const char c : file.text(material.name)) sum += c;
  }
  for (const Light& light : view.lights) {
    sum += light.intensity + static_cast<double>(file.text(light.name).size());
    if (light.voxel != none) sum += view.voxel_cells[light.voxel].run_count;
  }
  return sum;
}

/// Throws Error where an image cannot be decoded.
double follow_images(const View& view) {
  double sum = 0;
  for (uint32_t i = 0; i < view.images.size(); ++i) {
    const Texels texels = texels_of(view, i);
    for (const std::byte byte : texels.bytes()) sum += static_cast<double>(byte);
    if (texels.bytes().size() != image_bytes(view.images[i])) return NAN;
  }
  return sum;
}

/// Goes down each hierarchy as a shader would: one that is missed, one that is hit. Ends only if every skip leads on.
double follow_hierarchies(const View& view) {
  double sum = 0;
  const auto walk = [&](std::span<const BvhNode> nodes, bool hit, auto item) {
    for (uint32_t at = 0; at < nodes.size();) {
      const BvhNode& node = nodes[at];
      for (uint32_t i = 0; node.leaf != none && i < node.leaf % 16; ++i) sum += item(node.leaf / 16 + i);
      at = hit ? at + 1 : node.skip;
    }
  };
  for (const bool hit : {false, true}) {
    walk(view.batch_bvh, hit,
         [&](auto i) { return view.batch_instances[view.batch_bvh_items[i].batch_instance].batch; });
    walk(view.instance_bvh, hit, [&](auto i) { return view.instances[view.instance_bvh_items[i].instance].mesh; });
    walk(view.triangle_bvh, hit,
         [&](auto i) { return view.indices[3 * view.triangle_bvh_items[i].triangle + 2].vertex; });
    for (uint32_t at = 0; at < view.light_bvh.size();) {
      const LightBvhNode& node = view.light_bvh[at];
      if (node.light != none) sum += view.lights[node.light].intensity;
      at = hit ? at + 1 : node.miss;
    }
  }
  return sum;
}

double follow_voxels(const View& view) {
  double sum = 0;
  for (const VoxelRun& run : view.voxel_runs) {
    for (uint32_t i = 0; i < run.index_count; ++i) {
      const uint32_t vertex = view.voxel_indices[run.first_index + i].vertex;
      sum += run.instance == none ? view.voxel_vertices[vertex].position_ws.x : view.positions[vertex].position_ls.x;
    }
  }
  for (size_t i = 0; i < view.voxel_cells.size(); ++i) sum += view.voxel_occupancy[i / 32].bits >> i % 32 & 1;
  return sum;
}

double follow_motion(const View& view) {
  double sum = 0;
  for (const Animation& animation : view.animations) {
    for (const AnimationChannel& channel :
         view.animation_channels.subspan(animation.first_channel, animation.channel_count)) {
      const uint32_t width = channel.path == AnimationPath::rotation ? 4 : 3;
      const uint32_t each = channel.interpolation == Interpolation::cubic_spline ? 3 * width : width;
      for (uint32_t key = 0; key < channel.key_count; ++key) {
        sum += view.animation_times[channel.first_key + key].time_s + view.nodes[channel.node].scale.x;
        for (uint32_t i = 0; i < each; ++i) sum += view.animation_values[channel.first_value + key * each + i].value;
      }
    }
  }
  for (const Instance& instance : view.instances) {
    for (uint32_t node = instance.node; node != none; node = view.nodes[node].parent) sum += 1;
    if (instance.skin == none) continue;
    const Skin& skin = view.skins[instance.skin];
    const Mesh& mesh = view.meshes[instance.mesh];
    for (const SkinVertex& vertex : view.skin_vertices.subspan(mesh.first_skin_vertex, mesh.skin_vertex_count)) {
      const uint32_t joint = vertex.joints[0] & 0xffff;
      sum += view.nodes[view.joints[skin.first_joint + joint].node].rotation.w;
    }
  }
  return sum;
}

/// Follows every reference of an opened pack, as a renderer would. A sanitizer sees it if one leads astray.
double follow(const File& file) {
  return follow_draws(file) + follow_images(file.view()) + follow_hierarchies(file.view()) +
         follow_voxels(file.view()) + follow_motion(file.view());
}

// With right checksums a change may leave a valid pack. It must then be one that can be used; else it must be refused.
TEST_P(StoredPack, ChangesWithRightChecksumsAreRefusedOrHarmless) {
  const Target target(GetParam());
  std::mt19937 random(1);
  int refused = 0, harmless = 0;
  for (int round = 0; round < 20000; ++round) {
    std::vector<char> bytes = target.bytes;
    const int changes = 1 + round % 3;
    for (int i = 0; i < changes; ++i) bytes[random() % bytes.size()] = static_cast<char>(random());
    reseal(bytes);
    ASSERT_EQ(pwrite(target.descriptor, bytes.data(), bytes.size(), 0), static_cast<ssize_t>(bytes.size()));
    try {
      const File file(target.path);
      ASSERT_TRUE(std::isfinite(follow(file)));
      ++harmless;
    } catch (const Error&) {
      ++refused;
    }
  }
  EXPECT_GT(refused, 1000);
  EXPECT_GT(harmless, 100);
}

TEST(PackDamage, WhatIsNoPack) {
  const Folder folder;
  EXPECT_EQ(open_error(folder / "none"), "cannot open (No such file or directory)");
  std::filesystem::create_directory(folder / "folder");
  EXPECT_EQ(open_error(folder / "folder"), "not a file (a folder)");
  write_file(folder / "empty", {});
  EXPECT_EQ(open_error(folder / "empty"), "too short for a pack (0 bytes)");
  write_file(folder / "text", std::vector<char>(1000, 'x'));
  EXPECT_EQ(open_error(folder / "text"), "not a Chandelier pack (it begins with 78 78 78 78 78 78 78 78)");
  ASSERT_EQ(mkfifo((folder / "fifo").c_str(), 0600), 0);
  EXPECT_EQ(open_error(folder / "fifo"), "not a regular file");
}

}  // namespace
}  // namespace chandelier::pack::test
