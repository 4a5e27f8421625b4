// SPDX-License-Identifier: Apache-2.0
// Several inputs make one scene; .glb containers.
#include <gtest/gtest.h>

#include "gltf_builder.h"
#include "import/import.h"

namespace chandelier::baker::test {
namespace {

GltfBuilder rig() {
  GltfBuilder gltf;
  gltf.json["extensions"]["KHR_lights_punctual"]["lights"] = {{{"type", "point"}, {"range", 7}}};
  gltf.add_node({{"name", "lamp"}, {"extensions", {{"KHR_lights_punctual", {{"light", 0}}}}}});
  return gltf;
}

TEST(Merge, PutsASceneAndALightRigTogether) {
  GltfBuilder first = one_triangle(), second = one_triangle();
  first.json["materials"] = {{{"name", "brick"}}};
  first.json["meshes"][0]["primitives"][0]["material"] = 0;
  second.json["materials"] = {{{"name", "wood"}}};
  second.json["meshes"][0]["primitives"][0]["material"] = 0;
  Scene scene;
  Warnings warnings;
  import_gltf(first.save("first"), scene, warnings);
  import_gltf(second.save("second"), scene, warnings);
  import_gltf(rig().save("rig"), scene, warnings);
  const pack::Contents pack = bake_scene(std::move(scene), {});
  EXPECT_EQ(pack.instances.size(), 2u);
  ASSERT_EQ(pack.batches.size(), 2u);
  ASSERT_EQ(pack.materials.size(), 2u);
  EXPECT_EQ(text_of(pack, pack.materials[pack.batches[0].material].name), "brick");
  EXPECT_EQ(text_of(pack, pack.materials[pack.batches[1].material].name), "wood");
  // Each batch has vertices of its own file.
  EXPECT_EQ(pack.positions.size(), 6u);
  EXPECT_NE(pack.indices[pack.batches[0].first_index].vertex, pack.indices[pack.batches[1].first_index].vertex);
  ASSERT_EQ(pack.lights.size(), 1u);
  EXPECT_EQ(text_of(pack, pack.lights[0].name), "lamp");
  EXPECT_EQ(text_of(pack, pack.bake_info.source), "first.gltf\nsecond.gltf\nrig.gltf");
}

/// A .glb with the builder's buffer as its binary chunk.
std::string glb_of(const GltfBuilder& gltf) {
  Json json = gltf.json;
  json["buffers"] = {{{"byteLength", gltf.bytes.size()}}};
  std::string text = json.dump(), bin(gltf.bytes.begin(), gltf.bytes.end());
  text.resize((text.size() + 3) / 4 * 4, ' ');
  bin.resize((bin.size() + 3) / 4 * 4, '\0');
  const auto u32 = [](size_t value) {
    const auto v = static_cast<uint32_t>(value);
    return std::string(reinterpret_cast<const char*>(&v), 4);
  };
  return "glTF" + u32(2) + u32(12 + 8 + text.size() + 8 + bin.size()) + u32(text.size()) + "JSON" + text +
         u32(bin.size()) + std::string("BIN\0", 4) + bin;
}

TEST(Glb, IsReadLikeAGltf) {
  write_bytes(scratch_folder() / "scene.glb", glb_of(one_triangle()));
  EXPECT_EQ(error_of(scratch_folder() / "scene.glb"), "");
  Scene scene;
  Warnings warnings;
  import_gltf(scratch_folder() / "scene.glb", scene, warnings);
  EXPECT_EQ(scene.meshes.at(0).primitives.at(0).indices.size(), 3u);
}

TEST(Glb, IsRefusedWhereverItIsCut) {
  const std::string whole = glb_of(one_triangle());
  const std::filesystem::path path = scratch_folder() / "cut.glb";
  for (size_t size = 0; size < whole.size(); ++size) {
    write_bytes(path, whole.substr(0, size));
    EXPECT_NE(error_of(path), "") << size << " of " << whole.size() << " bytes";
  }
}

TEST(Glb, IsRefusedOrReadWhateverByteIsAltered) {
  const std::string whole = glb_of(one_triangle());
  const std::filesystem::path path = scratch_folder() / "altered.glb";
  for (size_t i = 0; i < whole.size(); ++i) {
    for (const char flip : {'\x01', '\x80', '\xFF'}) {
      std::string altered = whole;
      altered[i] = static_cast<char>(altered[i] ^ flip);
      write_bytes(path, altered);
      const std::string line = error_of(path);  // anything but a crash or another exception
      EXPECT_EQ(line.find('\n'), std::string::npos);
    }
  }
}

}  // namespace
}  // namespace chandelier::baker::test
