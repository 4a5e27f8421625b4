// SPDX-License-Identifier: Apache-2.0
// Accessors: component types, normalization, strides, offsets, sparse data, indices of each width.
#include <gtest/gtest.h>

#include "gltf_builder.h"

namespace chandelier::baker::test {
namespace {

const glm::vec3& position(const Scene& scene, size_t vertex) {
  return scene.meshes.at(0).primitives.at(0).vertices.at(vertex).position_ls;
}

/// Imports a triangle with the given POSITION accessor.
Scene with_positions(GltfBuilder& gltf, int accessor) {
  gltf.add_mesh({{"attributes", {{"POSITION", accessor}}}});
  gltf.add_node({{"mesh", 0}});
  return gltf.import();
}

template <typename T>
Scene with_integer_positions(int component_type, bool normalized, const std::vector<T>& values) {
  GltfBuilder gltf;
  return with_positions(gltf, gltf.add_accessor(values, component_type, "VEC3", 3, normalized));
}

TEST(Accessor, ReadsPlainIntegersOfEachType) {
  const Scene bytes = with_integer_positions<int8_t>(byte_type, false, {-128, 0, 127, 1, 0, 0, 0, 1, 0});
  EXPECT_EQ(position(bytes, 0), glm::vec3(-128, 0, 127));
  const Scene unsigned_bytes =
      with_integer_positions<uint8_t>(unsigned_byte_type, false, {255, 0, 7, 1, 0, 0, 0, 1, 0});
  EXPECT_EQ(position(unsigned_bytes, 0), glm::vec3(255, 0, 7));
  const Scene shorts = with_integer_positions<int16_t>(short_type, false, {-32768, 0, 32767, 1, 0, 0, 0, 1, 0});
  EXPECT_EQ(position(shorts, 0), glm::vec3(-32768, 0, 32767));
  const Scene unsigned_shorts =
      with_integer_positions<uint16_t>(unsigned_short_type, false, {65535, 0, 7, 1, 0, 0, 0, 1, 0});
  EXPECT_EQ(position(unsigned_shorts, 0), glm::vec3(65535, 0, 7));
  const Scene unsigned_ints =
      with_integer_positions<uint32_t>(unsigned_int_type, false, {1u << 31, 0, 7, 1, 0, 0, 0, 1, 0});
  EXPECT_EQ(position(unsigned_ints, 0), glm::vec3(2147483648.0f, 0, 7));
}

TEST(Accessor, NormalizesAsGltfSays) {
  // The most negative value and its neighbour are both -1.
  const Scene bytes = with_integer_positions<int8_t>(byte_type, true, {-128, -127, 127, 1, 0, 0, 0, 1, 0});
  EXPECT_EQ(position(bytes, 0), glm::vec3(-1, -1, 1));
  EXPECT_FLOAT_EQ(position(bytes, 1).x, 1.0f / 127);
  const Scene unsigned_bytes =
      with_integer_positions<uint8_t>(unsigned_byte_type, true, {255, 0, 51, 1, 0, 0, 0, 1, 0});
  EXPECT_EQ(position(unsigned_bytes, 0), glm::vec3(1, 0, 0.2f));
  const Scene shorts = with_integer_positions<int16_t>(short_type, true, {-32768, -32767, 32767, 1, 0, 0, 0, 1, 0});
  EXPECT_EQ(position(shorts, 0), glm::vec3(-1, -1, 1));
  const Scene unsigned_shorts =
      with_integer_positions<uint16_t>(unsigned_short_type, true, {65535, 0, 13107, 1, 0, 0, 0, 1, 0});
  EXPECT_EQ(position(unsigned_shorts, 0), glm::vec3(1, 0, 0.2f));
}

TEST(Accessor, HonoursStrideAndBothOffsets) {
  GltfBuilder gltf;
  gltf.add_view<float>({99, 99});  // so that the view does not start at byte 0
  // Vertices of 16 bytes: one float that is not ours, then the position.
  const int view = gltf.add_view<float>({-1, 1, 2, 3, -1, 4, 5, 6, -1, 7, 8, 10}, 16);
  const int accessor = gltf.append(
      "accessors",
      {{"bufferView", view}, {"byteOffset", 4}, {"componentType", float_type}, {"type", "VEC3"}, {"count", 3}});
  const Scene scene = with_positions(gltf, accessor);
  EXPECT_EQ(position(scene, 0), glm::vec3(1, 2, 3));
  EXPECT_EQ(position(scene, 1), glm::vec3(4, 5, 6));
  EXPECT_EQ(position(scene, 2), glm::vec3(7, 8, 10));
}

template <typename T>
void expect_sparse_index_type(int component_type) {
  GltfBuilder gltf;
  const int accessor = gltf.add_positions({0, 0, 0, 1, 0, 0, 0, 1, 0});
  gltf.json["accessors"][accessor]["sparse"] = {
      {"count", 2},
      {"indices", {{"bufferView", gltf.add_view<T>({0, 2})}, {"componentType", component_type}}},
      {"values", {{"bufferView", gltf.add_view<float>({5, 6, 7, 8, 9, 10})}}}};
  const Scene scene = with_positions(gltf, accessor);
  EXPECT_EQ(position(scene, 0), glm::vec3(5, 6, 7));
  EXPECT_EQ(position(scene, 1), glm::vec3(1, 0, 0));
  EXPECT_EQ(position(scene, 2), glm::vec3(8, 9, 10));
}

TEST(Accessor, ReplacesSparseElements) {
  expect_sparse_index_type<uint8_t>(unsigned_byte_type);
  expect_sparse_index_type<uint16_t>(unsigned_short_type);
  expect_sparse_index_type<uint32_t>(unsigned_int_type);
}

TEST(Accessor, IsZeroWhereSparseDataHasNoBase) {
  GltfBuilder gltf;
  const int accessor = gltf.append(
      "accessors",
      {{"componentType", float_type},
       {"type", "VEC3"},
       {"count", 3},
       {"sparse",
        {{"count", 2},
         {"indices", {{"bufferView", gltf.add_view<uint8_t>({1, 2})}, {"componentType", unsigned_byte_type}}},
         {"values", {{"bufferView", gltf.add_view<float>({1, 0, 0, 0, 1, 0})}}}}}});
  const Scene scene = with_positions(gltf, accessor);
  EXPECT_EQ(position(scene, 0), glm::vec3(0, 0, 0));
  EXPECT_EQ(position(scene, 1), glm::vec3(1, 0, 0));
  EXPECT_EQ(position(scene, 2), glm::vec3(0, 1, 0));
}

TEST(Accessor, ReadsIndicesThatAreAllSparse) {
  GltfBuilder gltf = one_triangle();
  gltf.json["accessors"][1] = {
      {"componentType", unsigned_short_type},
      {"type", "SCALAR"},
      {"count", 3},
      {"sparse",
       {{"count", 2},
        {"indices", {{"bufferView", gltf.add_view<uint8_t>({1, 2})}, {"componentType", unsigned_byte_type}}},
        {"values", {{"bufferView", gltf.add_view<uint16_t>({1, 2})}}}}}};
  EXPECT_EQ(gltf.bake().bake_info.unique_triangles, 1u);
}

template <typename T>
void expect_index_type(int component_type) {
  GltfBuilder gltf;
  const int positions = gltf.add_positions({0, 0, 0, 1, 0, 0, 0, 1, 0});
  const int normals = gltf.add_floats({0, 0, 1, 0, 0, 1, 0, 0, 1}, "VEC3", 3);
  gltf.add_mesh({{"attributes", {{"POSITION", positions}, {"NORMAL", normals}}},
                 {"indices", gltf.add_accessor<T>({2, 0, 1}, component_type, "SCALAR", 3)}});
  gltf.add_node({{"mesh", 0}});
  const Scene scene = gltf.import();
  EXPECT_EQ(scene.meshes.at(0).primitives.at(0).indices, (std::vector<uint32_t>{2, 0, 1}));
}

TEST(Accessor, ReadsIndicesOfEachWidth) {
  expect_index_type<uint8_t>(unsigned_byte_type);
  expect_index_type<uint16_t>(unsigned_short_type);
  expect_index_type<uint32_t>(unsigned_int_type);
}

}  // namespace
}  // namespace chandelier::baker::test
