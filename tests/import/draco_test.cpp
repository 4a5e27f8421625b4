// SPDX-License-Identifier: Apache-2.0
// KHR_draco_mesh_compression, by public models that exist compressed and plain.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>

#include "gltf_builder.h"
#include "import/import.h"

namespace chandelier::baker::test {
namespace {

const std::filesystem::path models = std::filesystem::path(CHANDELIER_DATA_DIR) / "models" / "khronos";

Scene import_file(const std::filesystem::path& path) {
  Scene scene;
  Warnings warnings;
  import_gltf(path, scene, warnings);
  return scene;
}

std::vector<glm::vec3> corners_of(const Scene& scene) {
  std::vector<glm::vec3> out;
  const Primitive& primitive = scene.meshes.at(0).primitives.at(0);
  for (const uint32_t index : primitive.indices) out.push_back(primitive.vertices[index].position_ls);
  return out;
}

/// The farthest that a corner of `a` is from the nearest corner of `b`.
float distance(const std::vector<glm::vec3>& a, const std::vector<glm::vec3>& b) {
  float farthest = 0;
  for (const glm::vec3& p : a) {
    float nearest = INFINITY;
    for (const glm::vec3& q : b) nearest = std::min(nearest, glm::length(p - q));
    farthest = std::max(farthest, nearest);
  }
  return farthest;
}

void expect_equal_within(const char* plain, const char* compressed, float error_m) {
  const Scene a = import_file(models / plain), b = import_file(models / compressed);
  const std::vector<glm::vec3> from = corners_of(a), to = corners_of(b);
  ASSERT_EQ(from.size(), to.size());
  EXPECT_LE(distance(from, to), error_m);
  EXPECT_LE(distance(to, from), error_m);
  const Primitive &p = a.meshes[0].primitives[0], &q = b.meshes[0].primitives[0];
  EXPECT_EQ(p.skin_vertices.empty(), q.skin_vertices.empty());
  EXPECT_EQ(q.skin_vertices.size(), q.skin_vertices.empty() ? 0 : q.vertices.size());
  EXPECT_EQ(p.needs_normals, q.needs_normals);
  EXPECT_EQ(a.animations.size(), b.animations.size());
}

TEST(Draco, EqualsThePlainModelWithinItsQuantization) {
  if (!std::filesystem::exists(models)) GTEST_SKIP() << "no " << models;
  expect_equal_within("Box/glTF-Binary/Box.glb", "Box/glTF-Draco/Box.gltf", 1e-3f);
  expect_equal_within("RiggedFigure/glTF/RiggedFigure.gltf", "RiggedFigure/glTF-Draco/RiggedFigure.gltf", 2e-3f);
}

std::string read_text(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

/// The compressed box in a folder of its own, whose stream a test may change.
struct CompressedBox {
  std::filesystem::path folder = scratch_folder() / "draco";
  Json json = Json::parse(read_text(models / "Box/glTF-Draco/Box.gltf"));
  std::string stream = read_text(models / "Box/glTF-Draco" / json["buffers"][0]["uri"].get<std::string>());

  std::string error() const {
    std::filesystem::create_directories(folder);
    write_bytes(folder / json["buffers"][0]["uri"].get<std::string>(), stream);
    write_bytes(folder / "box.gltf", json.dump());
    const std::string line = error_of(folder / "box.gltf");
    return line.substr(std::min(line.size(), (folder / "box.gltf").string().size() + 2));
  }
};

TEST(Draco, IsRefusedWhereItsNumbersDoNotFit) {
  if (!std::filesystem::exists(models)) GTEST_SKIP() << "no " << models;
  CompressedBox box;
  EXPECT_EQ(box.error(), "");
  const Json good = box.json;
  const auto primitive = [&]() -> Json& { return box.json["meshes"][0]["primitives"][0]; };
  const std::string at = ", primitive 0, KHR_draco_mesh_compression";
  box.json["accessors"][primitive()["attributes"]["POSITION"].get<size_t>()]["count"] = 23;
  EXPECT_NE(box.error().find("another number of vertices than its accessors, which have 23 (24)"), std::string::npos);
  box.json = good;
  box.json["accessors"][primitive()["indices"].get<size_t>()]["count"] = 39;
  EXPECT_NE(box.error().find("another number of triangle corners than its accessors, which have 39 (36)"),
            std::string::npos);
  box.json = good;
  primitive()["extensions"]["KHR_draco_mesh_compression"]["attributes"]["POSITION"] = 77;
  EXPECT_NE(box.error().find(at + ", attribute POSITION: Draco stream has no such attribute (77)"), std::string::npos);
  box.json = good;
  box.stream[0] = 'X';
  EXPECT_NE(box.error().find(at + ": is not a Draco stream"), std::string::npos);
}

TEST(Draco, SurvivesEveryChangedByteAndEveryTruncation) {
  if (!std::filesystem::exists(models)) GTEST_SKIP() << "no " << models;
  const CompressedBox good;
  size_t refused = 0;
  for (size_t i = 0; i < good.stream.size(); ++i) {
    for (const int change : {0x01, 0x80, 0xFF}) {
      CompressedBox box = good;
      box.stream[i] = static_cast<char>(box.stream[i] ^ change);
      refused += !box.error().empty();  // another exception, or a crash, fails the test
    }
    CompressedBox cut = good;
    const Json& extension = cut.json["meshes"][0]["primitives"][0]["extensions"]["KHR_draco_mesh_compression"];
    Json& view = cut.json["bufferViews"][extension["bufferView"].get<size_t>()];
    if (i < view["byteLength"].get<size_t>()) {
      view["byteLength"] = i;
      EXPECT_NE(cut.error(), "") << i;
    }
  }
  EXPECT_GT(refused, good.stream.size() / 4);
}

}  // namespace
}  // namespace chandelier::baker::test
