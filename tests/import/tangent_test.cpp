// SPDX-License-Identifier: Apache-2.0
// Tangents: which way they point, their sign, the seam between mirrored halves.
#include <gtest/gtest.h>

#include "bake/tangents.h"
#include "bake/weld.h"

namespace chandelier::baker::test {
namespace {

/// A square in z = 0 facing +z; uv as given for the corners (0,0) (1,0) (1,1) (0,1).
Primitive square(const glm::vec2 (&uv)[4]) {
  Primitive primitive;
  const glm::vec3 positions[] = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  for (int i = 0; i < 4; ++i) {
    Vertex vertex;
    vertex.position_ls = positions[i];
    vertex.normal_ls = {0, 0, 1};
    vertex.uv0 = uv[i];
    primitive.vertices.push_back(vertex);
  }
  primitive.indices = {0, 1, 2, 0, 2, 3};
  return primitive;
}

TEST(Tangents, PointAlongGrowingUWithPositiveSignWhereVPointsDown) {
  // The picture upright: u to the right, v = 0 at the top. Then the bitangent, cross(n, t) * w, is up: green's way.
  Primitive primitive = square({{0, 1}, {1, 1}, {1, 0}, {0, 0}});
  make_tangents(primitive);
  ASSERT_EQ(primitive.vertices.size(), 4u);
  for (const Vertex& vertex : primitive.vertices) EXPECT_EQ(vertex.tangent_ls, glm::vec4(1, 0, 0, 1));
}

TEST(Tangents, HaveNegativeSignWhereThePictureIsMirrored) {
  Primitive primitive = square({{1, 1}, {0, 1}, {0, 0}, {1, 0}});  // u to the left
  make_tangents(primitive);
  for (const Vertex& vertex : primitive.vertices) EXPECT_EQ(vertex.tangent_ls, glm::vec4(-1, 0, 0, -1));
}

TEST(Tangents, FollowTheSecondTextureCoordinatesWhereTheNormalMapDoes) {
  Primitive primitive = square({{0, 1}, {1, 1}, {1, 0}, {0, 0}});
  for (Vertex& vertex : primitive.vertices) vertex.uv1 = {1 - vertex.uv0.y, vertex.uv0.x};  // u up, v right
  primitive.tangents_from_uv1 = true;
  make_tangents(primitive);
  // u grows upward, and v to the right, so that green's way (against v) is left: cross(+z, +y) = -x, w = +1.
  for (const Vertex& vertex : primitive.vertices) EXPECT_EQ(vertex.tangent_ls, glm::vec4(0, 1, 0, 1));
}

TEST(Tangents, SplitVerticesBetweenMirroredHalves) {
  // Two quads side by side, the picture mirrored about the shared edge x = 1: (u is 0, 1, 0 along x).
  Primitive primitive;
  for (int y = 0; y < 2; ++y) {
    for (int x = 0; x < 3; ++x) {
      Vertex vertex;
      vertex.position_ls = {x, y, 0};
      vertex.normal_ls = {0, 0, 1};
      vertex.uv0 = {x == 1, 1 - y};
      primitive.vertices.push_back(vertex);
    }
  }
  primitive.indices = {0, 1, 4, 0, 4, 3, 1, 2, 5, 1, 5, 4};
  make_tangents(primitive);
  EXPECT_EQ(primitive.vertices.size(), 8u);  // the shared edge's two vertices are there twice
  for (size_t i = 0; i < primitive.indices.size(); ++i) {
    const bool left = i < 6;
    EXPECT_EQ(primitive.vertices[primitive.indices[i]].tangent_ls,
              left ? glm::vec4(1, 0, 0, 1) : glm::vec4(-1, 0, 0, -1));
  }
}

TEST(Tangents, AreAcrossTheNormalWhereTextureCoordinatesSayNothing) {
  Primitive primitive = square({{0, 0}, {0, 0}, {0, 0}, {0, 0}});
  make_tangents(primitive);
  for (const Vertex& vertex : primitive.vertices) {
    EXPECT_NEAR(glm::length(glm::vec3(vertex.tangent_ls)), 1, 1e-6);
    EXPECT_NEAR(glm::dot(glm::vec3(vertex.tangent_ls), vertex.normal_ls), 0, 1e-6);
  }
}

TEST(Tangents, KeepJointsAndWeightsWithTheirVertices) {
  Scene scene;
  scene.meshes.resize(1);
  scene.meshes[0].primitives.push_back(square({{0, 1}, {1, 1}, {0, 0}, {1, 0}}));  // the upper half is mirrored
  Primitive& primitive = scene.meshes[0].primitives[0];
  primitive.needs_tangents = true;
  for (uint16_t i = 0; i < 4; ++i) primitive.skin_vertices.push_back({{i, 0, 0, 0}, {65535, 0, 0, 0}});
  EXPECT_EQ(make_tangents(scene), 1u);
  ASSERT_EQ(primitive.skin_vertices.size(), primitive.vertices.size());
  EXPECT_GT(primitive.vertices.size(), 4u);
  const glm::vec3 corners[] = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  for (size_t i = 0; i < primitive.vertices.size(); ++i) {
    EXPECT_EQ(primitive.vertices[i].position_ls, corners[primitive.skin_vertices[i].joints[0]]);
  }
}

TEST(Weld, MergesEqualVertices) {
  Primitive primitive = square({{0, 1}, {1, 1}, {1, 0}, {0, 0}});
  const Vertex first = primitive.vertices[0];
  primitive.vertices.push_back(first);  // number 4 is number 0 again
  primitive.indices.insert(primitive.indices.end(), {4, 2, 3});
  weld(primitive);
  EXPECT_EQ(primitive.vertices.size(), 4u);
  EXPECT_EQ(primitive.indices, (std::vector<uint32_t>{0, 1, 2, 0, 2, 3, 0, 2, 3}));
}

TEST(Weld, KeepsVerticesApartThatDifferInJointsAlone) {
  Primitive primitive = square({{0, 1}, {1, 1}, {1, 0}, {0, 0}});
  primitive.vertices.push_back(primitive.vertices[0]);
  primitive.skin_vertices.resize(5);
  primitive.skin_vertices[4].joints[0] = 1;
  primitive.indices.insert(primitive.indices.end(), {4, 2, 3});
  weld(primitive);
  EXPECT_EQ(primitive.vertices.size(), 5u);
  EXPECT_EQ(primitive.skin_vertices.size(), 5u);
}

}  // namespace
}  // namespace chandelier::baker::test
