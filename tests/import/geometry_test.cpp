// SPDX-License-Identifier: Apache-2.0
// Primitives: modes, missing indices and normals, texture coordinates, vertex colours.
#include "import/geometry.h"

#include <gtest/gtest.h>

#include "gltf_builder.h"

namespace chandelier::baker::test {
namespace {

using Indices = std::vector<uint32_t>;

constexpr int points_mode = 0, lines_mode = 1, triangles_mode = 4, strip_mode = 5, fan_mode = 6;

TEST(TriangleList, FollowsTheFormulasOfTheModes) {
  EXPECT_EQ(triangle_list(triangles_mode, {0, 1, 2, 3, 4, 5, 6}), (Indices{0, 1, 2, 3, 4, 5}));
  EXPECT_EQ(triangle_list(strip_mode, {10, 11, 12, 13, 14}), (Indices{10, 11, 12, 11, 13, 12, 12, 13, 14}));
  EXPECT_EQ(triangle_list(fan_mode, {10, 11, 12, 13}), (Indices{11, 12, 10, 12, 13, 10}));
  EXPECT_EQ(triangle_list(strip_mode, {0, 1}), Indices{});
}

/// Corners of the unit square in strip order: the two triangles of a strip both face +z.
const std::vector<float> strip_square = {0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0};

GltfBuilder primitive_of_mode(int mode) {
  GltfBuilder gltf;
  gltf.add_mesh({{"attributes", {{"POSITION", gltf.add_positions(strip_square)}}}, {"mode", mode}});
  gltf.add_node({{"mesh", 0}});
  return gltf;
}

TEST(Primitive, MakesStripsAndFansWithoutIndicesFaceTheRightWay) {
  for (const int mode : {strip_mode, fan_mode}) {
    GltfBuilder gltf = primitive_of_mode(mode);
    // A fan goes around: its square needs the last two corners swapped.
    if (mode == fan_mode) {
      gltf.json["meshes"][0]["primitives"][0]["attributes"]["POSITION"] =
          gltf.add_positions({0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0});
    }
    const Scene scene = gltf.import();
    const Primitive& primitive = scene.meshes.at(0).primitives.at(0);
    ASSERT_EQ(primitive.indices.size(), 6u);
    for (size_t i = 0; i < 6; i += 3) {
      const auto corner = [&](size_t c) { return primitive.vertices[primitive.indices[i + c]].position_ls; };
      EXPECT_GT(glm::cross(corner(1) - corner(0), corner(2) - corner(0)).z, 0) << "mode " << mode;
    }
  }
}

TEST(Primitive, SkipsPointsAndLinesWithAWarning) {
  for (const int mode : {points_mode, lines_mode, 2, 3}) {
    Warnings warnings;
    const Scene scene = primitive_of_mode(mode).import(&warnings);
    EXPECT_TRUE(scene.meshes.at(0).primitives.empty());
    ASSERT_EQ(warnings.lines().size(), 1u);
    EXPECT_NE(warnings.lines()[0].find("mesh 0, primitive 0: points and lines are skipped"), std::string::npos);
  }
}

TEST(Primitive, SaysWhereItHasNoNormals) {
  GltfBuilder gltf = one_triangle();
  EXPECT_TRUE(gltf.import().meshes.at(0).primitives.at(0).needs_normals);
  gltf.json["meshes"][0]["primitives"][0]["attributes"]["NORMAL"] = gltf.add_positions({0, 0, 1, 0, 0, 1, 0, 0, 1});
  EXPECT_FALSE(gltf.import().meshes.at(0).primitives.at(0).needs_normals);
}

TEST(Primitive, MakesNormalsUnitLengthAndMendsThoseOfLengthZero) {
  GltfBuilder gltf = one_triangle();
  gltf.json["meshes"][0]["primitives"][0]["attributes"]["NORMAL"] =
      gltf.add_floats({0, 3, 4, 0, 0, 0, 2, 0, 0}, "VEC3", 3);
  const Primitive primitive = gltf.import().meshes.at(0).primitives.at(0);
  EXPECT_EQ(primitive.vertices[0].normal_ls, glm::vec3(0, 0.6f, 0.8f));
  EXPECT_EQ(primitive.vertices[1].normal_ls, glm::vec3(0, 0, 1));  // the triangle's
  EXPECT_EQ(primitive.vertices[2].normal_ls, glm::vec3(1, 0, 0));
}

TEST(Primitive, ReadsBothTextureCoordinateSetsOfAnyType) {
  GltfBuilder gltf = one_triangle();
  Json& attributes = gltf.json["meshes"][0]["primitives"][0]["attributes"];
  attributes["TEXCOORD_0"] = gltf.add_floats({0, 1, 2, 3, 4, 5}, "VEC2", 2);
  attributes["TEXCOORD_1"] = gltf.add_accessor<uint8_t>({0, 255, 51, 0, 255, 255}, unsigned_byte_type, "VEC2", 3, true);
  const Primitive primitive = gltf.import().meshes.at(0).primitives.at(0);
  EXPECT_EQ(primitive.vertices[1].uv0, glm::vec2(2, 3));
  EXPECT_EQ(primitive.vertices[1].uv1, glm::vec2(0.2f, 0));
}

uint32_t color_of(GltfBuilder gltf, int accessor) {
  gltf.json["meshes"][0]["primitives"][0]["attributes"]["COLOR_0"] = accessor;
  return gltf.import().meshes.at(0).primitives.at(0).vertices.at(0).color;
}

TEST(Primitive, PacksVertexColoursOfEachType) {
  GltfBuilder gltf = one_triangle();
  // 1.0 -> 255, 0.5 -> 127.5 rounds to 128, 0.2 -> 51; clamped above 1; alpha 255 where there is none.
  EXPECT_EQ(color_of(gltf, gltf.add_floats({1, 0.5f, 0.2f, 0, 0, 0, 0, 0, 0}, "VEC3", 3)), 0xFF3380FFu);
  EXPECT_EQ(color_of(gltf, gltf.add_floats({2, 0.5f, 0.2f, 0, 0, 0, 0, 0, 0, 0, 0, 0}, "VEC4", 4)), 0x003380FFu);
  EXPECT_EQ(color_of(gltf, gltf.add_accessor<uint8_t>({1, 2, 3, 4, 0, 0, 0, 0, 0, 0, 0, 0}, unsigned_byte_type, "VEC4",
                                                      3, true)),
            0x04030201u);
  EXPECT_EQ(color_of(gltf, gltf.add_accessor<uint16_t>({65535, 257, 0, 0, 0, 0, 0, 0, 0}, unsigned_short_type, "VEC3",
                                                       3, true)),
            0xFF0001FFu);
  EXPECT_EQ(one_triangle().import().meshes.at(0).primitives.at(0).vertices.at(0).color, 0xFFFFFFFFu);
}

}  // namespace
}  // namespace chandelier::baker::test
