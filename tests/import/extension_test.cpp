// SPDX-License-Identifier: Apache-2.0
// Extensions: compressed buffer views, instances, texture transforms, images of other formats, unlit materials.
#include <gtest/gtest.h>
#include <meshoptimizer.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "gltf_builder.h"
#include "import/import.h"

namespace chandelier::baker::test {
namespace {

using Bytes = std::vector<uint8_t>;

Json& primitive(GltfBuilder& gltf) {
  return gltf.json["meshes"][0]["primitives"][0];
}

/// A grid of quads in the plane z = 0.
struct Grid {
  std::vector<float> positions;
  std::vector<uint32_t> indices;
};

Grid make_grid(uint32_t side) {
  Grid out;
  for (uint32_t y = 0; y <= side; ++y) {
    for (uint32_t x = 0; x <= side; ++x) {
      out.positions.insert(out.positions.end(), {static_cast<float>(x), static_cast<float>(y) * 0.5f, 0});
      if (x == side || y == side) continue;
      const uint32_t a = y * (side + 1) + x, b = a + side + 1;
      out.indices.insert(out.indices.end(), {a, a + 1, b, b, a + 1, b + 1});
    }
  }
  return out;
}

/// A buffer view whose data is compressed; its own buffer, number 1, is a fallback without data.
int add_compressed(GltfBuilder& gltf, const Bytes& data, const char* mode, size_t count, size_t stride,
                   const char* filter = nullptr) {
  const int view = gltf.add_view(data);
  Json& json = gltf.json["bufferViews"][view];
  Json extension = {{"buffer", 0},
                    {"byteOffset", json["byteOffset"]},
                    {"byteLength", data.size()},
                    {"mode", mode},
                    {"count", count},
                    {"byteStride", stride}};
  if (filter) extension["filter"] = filter;
  json = {{"buffer", 1}, {"byteLength", count * stride}, {"extensions", {{"EXT_meshopt_compression", extension}}}};
  if (std::string(mode) == "ATTRIBUTES") json["byteStride"] = stride;
  return view;
}

/// Where a rotation takes (1, 0, 0).
glm::dvec3 turned_by(const float* xyzw) {
  const double x = xyzw[0], y = xyzw[1], z = xyzw[2], w = xyzw[3];
  return {1 - 2 * (y * y + z * z), 2 * (x * y + w * z), 2 * (x * z - w * y)};
}

Bytes encode_vertices(const void* data, size_t count, size_t stride) {
  Bytes out(meshopt_encodeVertexBufferBound(count, stride));
  out.resize(meshopt_encodeVertexBuffer(out.data(), out.size(), data, count, stride));
  return out;
}

Bytes encode_triangles(const std::vector<uint32_t>& indices, size_t vertices) {
  Bytes out(meshopt_encodeIndexBufferBound(indices.size(), vertices));
  out.resize(meshopt_encodeIndexBuffer(out.data(), out.size(), indices.data(), indices.size()));
  return out;
}

Bytes encode_sequence(const std::vector<uint32_t>& indices, size_t vertices) {
  Bytes out(meshopt_encodeIndexSequenceBound(indices.size(), vertices));
  out.resize(meshopt_encodeIndexSequence(out.data(), out.size(), indices.data(), indices.size()));
  return out;
}

/// View 0: positions, view 1: indices. The builder writes buffer 0; buffer 1 is added to its text.
GltfBuilder compressed_grid(bool as_sequence) {
  const Grid grid = make_grid(20);
  const size_t vertices = grid.positions.size() / 3;
  GltfBuilder gltf;
  gltf.fallback_bytes = 1u << 20;
  const int positions =
      add_compressed(gltf, encode_vertices(grid.positions.data(), vertices, 12), "ATTRIBUTES", vertices, 12);
  const int indices = add_compressed(
      gltf, as_sequence ? encode_sequence(grid.indices, vertices) : encode_triangles(grid.indices, vertices),
      as_sequence ? "INDICES" : "TRIANGLES", grid.indices.size(), 4);
  const int position = gltf.append(
      "accessors", {{"bufferView", positions}, {"componentType", float_type}, {"type", "VEC3"}, {"count", vertices}});
  const int index = gltf.append("accessors", {{"bufferView", indices},
                                              {"componentType", unsigned_int_type},
                                              {"type", "SCALAR"},
                                              {"count", grid.indices.size()}});
  gltf.add_mesh({{"attributes", {{"POSITION", position}}}, {"indices", index}});
  gltf.add_node({{"mesh", 0}});
  return gltf;
}

TEST(Meshopt, DecodesVerticesTrianglesAndSequences) {
  const Grid grid = make_grid(20);
  for (const bool as_sequence : {false, true}) {
    const Scene scene = compressed_grid(as_sequence).import();
    const Primitive& read = scene.meshes.at(0).primitives.at(0);
    ASSERT_EQ(read.vertices.size() * 3, grid.positions.size());
    for (size_t i = 0; i < read.vertices.size(); ++i) {
      EXPECT_EQ(read.vertices[i].position_ls, glm::vec3(grid.positions[3 * i], grid.positions[3 * i + 1], 0));
    }
    ASSERT_EQ(read.indices.size(), grid.indices.size());
    for (size_t i = 0; i < grid.indices.size(); i += 3) {  // the codec may begin a triangle at another corner
      const auto first = std::find(&read.indices[i], &read.indices[i] + 3, grid.indices[i]) - &read.indices[i];
      ASSERT_LT(first, 3);
      EXPECT_EQ(read.indices[i + static_cast<size_t>(first + 1) % 3], grid.indices[i + 1]);
    }
  }
}

TEST(Meshopt, AppliesTheOctahedralAndTheExponentialFilter) {
  const std::vector<float> normals = {0, 0.6f, 0.8f, 0, 1, 0, 0, 0, -0.6f, 0, 0.8f, 0};
  Bytes octahedral(12);
  meshopt_encodeFilterOct(octahedral.data(), 3, 4, 8, normals.data());
  const std::vector<float> uvs = {0.25f, 3, -1, 0.125f, 100, 0};
  Bytes exponential(24);
  meshopt_encodeFilterExp(exponential.data(), 3, 8, 15, uvs.data());
  GltfBuilder gltf = one_triangle();
  gltf.fallback_bytes = 1u << 20;
  const int n = add_compressed(gltf, encode_vertices(octahedral.data(), 3, 4), "ATTRIBUTES", 3, 4, "OCTAHEDRAL");
  const int e = add_compressed(gltf, encode_vertices(exponential.data(), 3, 8), "ATTRIBUTES", 3, 8, "EXPONENTIAL");
  primitive(gltf)["attributes"]["NORMAL"] = gltf.append(
      "accessors",
      {{"bufferView", n}, {"componentType", byte_type}, {"type", "VEC3"}, {"count", 3}, {"normalized", true}});
  primitive(gltf)["attributes"]["TEXCOORD_0"] =
      gltf.append("accessors", {{"bufferView", e}, {"componentType", float_type}, {"type", "VEC2"}, {"count", 3}});
  const Scene scene = gltf.import();
  const Primitive& read = scene.meshes.at(0).primitives.at(0);
  for (size_t i = 0; i < 3; ++i) {
    const glm::vec3 normal(normals[4 * i], normals[4 * i + 1], normals[4 * i + 2]);
    EXPECT_LT(glm::length(read.vertices[i].normal_ls - normal), 0.03f);
    EXPECT_LT(glm::length(read.vertices[i].uv0 - glm::vec2(uvs[2 * i], uvs[2 * i + 1])), 0.01f);
  }
}

// The filter is of four shorts; a glTF's rotations are where it may stand.
TEST(Meshopt, AppliesTheQuaternionFilter) {
  const float half = std::sqrt(0.5f);
  const std::vector<float> rotations = {0.5f, -0.5f, 0.5f, 0.5f, 0, 0, half, half};
  Bytes filtered(16);
  meshopt_encodeFilterQuat(filtered.data(), 2, 8, 16, rotations.data());
  GltfBuilder gltf = one_triangle();
  gltf.fallback_bytes = 1u << 20;
  const int view = add_compressed(gltf, encode_vertices(filtered.data(), 2, 8), "ATTRIBUTES", 2, 8, "QUATERNION");
  const int accessor = gltf.append(
      "accessors",
      {{"bufferView", view}, {"componentType", short_type}, {"type", "VEC4"}, {"count", 2}, {"normalized", true}});
  gltf.json["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"] = {{"ROTATION", accessor}};
  const Scene scene = gltf.import();
  ASSERT_EQ(scene.instances.size(), 2u);
  const auto turned = [&](size_t i) { return glm::dvec3(scene.instances[i].world_from_local[0]); };  // (1, 0, 0)
  EXPECT_LT(glm::length(turned(0) - turned_by(rotations.data())), 1e-3);
  EXPECT_LT(glm::length(turned(1) - glm::dvec3(0, 1, 0)), 1e-3);
}

std::string meshopt_error(const std::function<void(Json&, GltfBuilder&)>& spoil) {
  GltfBuilder gltf = compressed_grid(false);
  spoil(gltf.json["bufferViews"][0]["extensions"]["EXT_meshopt_compression"], gltf);
  const std::filesystem::path path = gltf.save("meshopt");
  const std::string line = error_of(path);
  return line.substr(std::min(line.size(), path.string().size() + 2));
}

TEST(Meshopt, IsRefusedWhereItsNumbersDoNotFit) {
  const std::string at = "buffer view 0, extensions, EXT_meshopt_compression, ";
  EXPECT_EQ(meshopt_error([](Json& e, GltfBuilder&) { e["byteStride"] = 6; }),
            at + "byteStride: does not suit its mode (6)");
  EXPECT_EQ(meshopt_error([](Json& e, GltfBuilder&) { e["byteStride"] = 260; }),
            at + "byteStride: is out of range (260)");
  EXPECT_EQ(meshopt_error([](Json& e, GltfBuilder&) { e["mode"] = "POINTS"; }), at + "mode: is unknown (\"POINTS\")");
  EXPECT_EQ(meshopt_error([](Json& e, GltfBuilder&) { e["count"] = 440; }),
            at + "count: times byteStride is not the buffer view's byteLength (440)");
  EXPECT_EQ(meshopt_error([](Json& e, GltfBuilder&) { e["filter"] = "OCTAHEDRAL"; }),
            at + "filter: does not suit its mode and byteStride, or is unknown (\"OCTAHEDRAL\")");
  EXPECT_EQ(meshopt_error([](Json& e, GltfBuilder&) { e["buffer"] = 2; }),
            at + "buffer: points past the end, there are 2 (2)");
  EXPECT_EQ(meshopt_error([](Json& e, GltfBuilder& g) {
              e["count"] = 1200000000;
              g.json["bufferViews"][0]["byteLength"] = 14400000000;
            }),
            at + "byteLength: is too short for its count (" +
                std::to_string(encode_vertices(make_grid(20).positions.data(), 441, 12).size()) + ")");
  EXPECT_NE(meshopt_error([](Json& e, GltfBuilder&) { e["byteOffset"] = 999999; }).find("ends past buffer 0"),
            std::string::npos);
}

TEST(Meshopt, SurvivesEveryChangedByte) {
  const GltfBuilder good = compressed_grid(false);
  size_t refused = 0;
  for (size_t i = 0; i < good.bytes.size(); ++i) {
    GltfBuilder gltf = good;
    gltf.bytes[i] ^= 0xFF;
    refused += !error_of(gltf.save("meshopt")).empty();  // another exception, or a crash, fails the test
  }
  EXPECT_GT(refused, 1u);
}

TEST(Instancing, PlacesTheMeshOncePerElement) {
  GltfBuilder gltf = one_triangle();
  const float half = std::sqrt(0.5f);
  const Json attributes = {{"TRANSLATION", gltf.add_positions({1, 2, 3, 4, 5, 6})},
                           {"ROTATION", gltf.add_floats({0, 0, 0, 1, 0, 0, half, half}, "VEC4", 4)},
                           {"SCALE", gltf.add_positions({1, 1, 1, 2, 3, 4})}};
  gltf.json["nodes"][0]["translation"] = {100, 0, 0};
  gltf.json["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"] = attributes;
  const Scene scene = gltf.import();
  ASSERT_EQ(scene.instances.size(), 2u);
  const auto moved = [&](size_t i) { return glm::dvec3(scene.instances[i].world_from_local * glm::dvec4(1, 1, 0, 1)); };
  EXPECT_LT(glm::length(moved(0) - glm::dvec3(102, 3, 3)), 1e-6);
  // (1,1,0): scaled (2,3,0), turned a quarter about z (-3,2,0), moved (1,7,6), and the node's own 100.
  EXPECT_LT(glm::length(moved(1) - glm::dvec3(101, 7, 6)), 1e-5);
}

TEST(Instancing, MirrorsCopiesWithFrontsCounterClockwiseInTheWorld) {
  GltfBuilder gltf = one_triangle();
  gltf.json["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"] = {
      {"TRANSLATION", gltf.add_positions({0, 0, 0, 3, 0, 0})}, {"SCALE", gltf.add_positions({1, 1, 1, -1, 1, 1})}};
  const pack::Contents pack = gltf.bake();
  ASSERT_EQ(pack.instances.size(), 2u);
  EXPECT_NE(pack.instances[0].mesh, pack.instances[1].mesh);
  for (const pack::BatchInstance& draw : pack.batch_instances) {
    const pack::Instance& instance = pack.instances[draw.instance];
    glm::vec3 corner[3];
    for (uint32_t c = 0; c < 3; ++c) {
      const auto& index = pack.indices[pack.batches[draw.batch].first_index + c];
      const glm::vec4 local(pack.positions[index.vertex].position_ls, 1);
      for (int row = 0; row < 3; ++row) corner[c][row] = glm::dot(instance.world_from_local[row], local);
    }
    // The front looks to where it looked: a mirror in x leaves +z.
    EXPECT_GT(glm::cross(corner[1] - corner[0], corner[2] - corner[0]).z, 0.9f);
  }
}

TEST(Instancing, MovesItsCopiesWithTheNodeAbove) {
  GltfBuilder gltf = one_triangle();
  gltf.json["nodes"][0]["translation"] = {0, 5, 0};
  gltf.json["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"] = {
      {"TRANSLATION", gltf.add_positions({0, 0, 0, 3, 0, 0})}};
  gltf.add_node({{"name", "arm"}, {"children", {0}}, {"translation", {100, 0, 0}}});
  const Json animated = {{"sampler", 0}, {"target", {{"node", 1}, {"path", "translation"}}}};
  gltf.json["animations"] = {
      {{"samplers",
        {{{"input", gltf.add_floats({0, 1}, "SCALAR", 1)}, {"output", gltf.add_positions({100, 0, 0, 100, 0, 50})}}}},
       {"channels", {animated}}}};
  const pack::Contents pack = gltf.bake();
  ASSERT_EQ(pack.instances.size(), 2u);
  ASSERT_EQ(pack.nodes.size(), 2u);
  for (size_t i = 0; i < 2; ++i) {
    const pack::Instance& instance = pack.instances[i];
    EXPECT_EQ(instance.dynamic, 1u);
    EXPECT_EQ(text_of(pack, pack.nodes.at(instance.node).name), "triangle");
    // node_world_now · inverse(node_world_rest) · world_from_local, all of them translations: now 50 along z.
    const glm::vec3 rest(100, 5, 0), now(100, 5, 50);
    glm::vec3 at;
    for (int row = 0; row < 3; ++row) at[row] = instance.world_from_local[row].w;
    EXPECT_EQ(now - rest + at, glm::vec3(100 + 3 * static_cast<float>(i), 5, 50));
  }
}

TEST(Instancing, NeedsEqualCounts) {
  GltfBuilder gltf = one_triangle();
  gltf.json["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"] = {
      {"TRANSLATION", gltf.add_positions({1, 2, 3, 4, 5, 6})}, {"SCALE", gltf.add_positions({1, 1, 1})}};
  EXPECT_NE(error_of(gltf.save("bad"))
                .find("node 0 'triangle', EXT_mesh_gpu_instancing: its attributes have different counts (1 and 2)"),
            std::string::npos);
}

GltfBuilder with_base_color(const Json& texture_info, const Json& texture) {
  GltfBuilder gltf = one_triangle();
  gltf.json["materials"] = {{{"pbrMetallicRoughness", {{"baseColorTexture", texture_info}}}}};
  gltf.json["images"] = {
      {{"uri", "data:image/png;base64," + base64({0x89, 'P', 'N', 'G'})}},
      {{"uri", "data:image/ktx2;base64," + base64({0xAB, 'K', 'T', 'X', ' ', '2', '0', 0xBB, 0x0D, 0x0A})}}};
  gltf.json["textures"] = {texture};
  primitive(gltf)["material"] = 0;
  return gltf;
}

TEST(TextureTransform, IsAMatrixOfScaleThenRotationThenOffset) {
  const Json transform = {{"offset", {-0.2, -0.1}}, {"rotation", 0.3}, {"scale", {1.5, 2}}, {"texCoord", 1}};
  const Scene scene =
      with_base_color({{"index", 0}, {"extensions", {{"KHR_texture_transform", transform}}}}, {{"source", 0}}).import();
  const TextureUse& use = scene.materials.at(0).base_color;
  EXPECT_TRUE(use.uv1);
  const auto mapped = [&](const glm::vec2& uv) {
    return glm::vec2(glm::dot(use.uv_transform[0], glm::vec3(uv, 1)), glm::dot(use.uv_transform[1], glm::vec3(uv, 1)));
  };
  const float c = std::cos(0.3f), s = std::sin(0.3f);
  EXPECT_LT(glm::length(mapped({0, 0}) - glm::vec2(-0.2f, -0.1f)), 1e-6f);
  EXPECT_LT(glm::length(mapped({1, 0}) - glm::vec2(1.5f * c - 0.2f, -1.5f * s - 0.1f)), 1e-6f);
  EXPECT_LT(glm::length(mapped({0, 1}) - glm::vec2(2 * s - 0.2f, 2 * c - 0.1f)), 1e-6f);
}

// The public model marks where the arrow's tip must appear: at the image's (0.69, 0.69) in all of its tests.
TEST(TextureTransform, PutsTheTestModelsArrowsOnTheirMarks) {
  const std::filesystem::path path =
      std::filesystem::path(CHANDELIER_DATA_DIR) / "models/khronos/TextureTransformTest/glTF/TextureTransformTest.gltf";
  if (!std::filesystem::exists(path)) GTEST_SKIP() << "no " << path;
  Scene scene;
  Warnings warnings;
  import_gltf(path, scene, warnings);
  const struct {
    const char* name;
    glm::vec2 mark;  // in the mesh's uv, from where the model's own marker stands
    glm::vec2 tip;   // in the image
  } marks[] = {{"Rotation", {0.42095f, 1.01627f}, {0.7778f, 0.7778f}},
               {"Scale", {0.51854f, 0.51854f}, {0.7778f, 0.7778f}}};
  for (const auto& each : marks) {
    const auto material = std::find_if(scene.materials.begin(), scene.materials.end(),
                                       [&](const Material& m) { return m.name == each.name; });
    ASSERT_NE(material, scene.materials.end());
    const UvTransform& rows = material->base_color.uv_transform;
    const glm::vec2 at(glm::dot(rows[0], glm::vec3(each.mark, 1)), glm::dot(rows[1], glm::vec3(each.mark, 1)));
    EXPECT_LT(glm::length(at - each.tip), 1e-3f) << each.name << " " << at.x << " " << at.y;
  }
}

TEST(TextureSource, FallsBackToThePlainImage) {
  for (const char* extension : {"KHR_texture_basisu", "EXT_texture_webp"}) {
    Warnings warnings;
    const Scene scene =
        with_base_color({{"index", 0}}, {{"source", 0}, {"extensions", {{extension, {{"source", 1}}}}}}).import();
    ASSERT_EQ(scene.images.size(), 1u);
    EXPECT_EQ(scene.images[0].bytes[1], 'P');
    EXPECT_NE(scene.materials.at(0).base_color.texture, no_index);
  }
}

TEST(TextureSource, IsLeftOutByNameWhereThereIsNoImageThatIsDecoded) {
  for (const Json& texture : {Json{{"extensions", {{"KHR_texture_basisu", {{"source", 1}}}}}}, Json{{"source", 1}}}) {
    Warnings warnings;
    const Scene scene = with_base_color({{"index", 0}}, texture).import(&warnings);
    EXPECT_EQ(scene.materials.at(0).base_color.texture, no_index);
    ASSERT_GE(warnings.lines().size(), 1u);
    EXPECT_NE(warnings.lines().back().find(
                  "has no PNG, JPEG or WebP image but only that of KHR_texture_basisu and is left out"),
              std::string::npos);
  }
}

TEST(TextureSource, OfEmissionThatIsLeftOutLeavesNoGlow) {
  for (const Json& info : {Json{{"index", 0}}, Json{{"index", 1}, {"texCoord", 2}}, Json{{"index", 1}}}) {
    GltfBuilder gltf = with_base_color({{"index", 1}}, {{"extensions", {{"KHR_texture_basisu", {{"source", 1}}}}}});
    gltf.append("textures", {{"source", 0}});
    gltf.json["materials"][0]["emissiveTexture"] = info;
    gltf.json["materials"][0]["emissiveFactor"] = {1, 1, 1};
    const bool kept = info == Json{{"index", 1}};
    const Scene scene = gltf.import();
    EXPECT_EQ(scene.materials.at(0).emissive, glm::vec3(kept ? 1.0f : 0.0f)) << info;
    EXPECT_EQ(scene.materials.at(0).emissive_map.texture == no_index, !kept) << info;
  }
}

TEST(TextureSource, IsAnErrorWhereItsAlphaWouldMakeShadows) {
  GltfBuilder gltf = with_base_color({{"index", 0}}, {{"extensions", {{"KHR_texture_basisu", {{"source", 1}}}}}});
  gltf.json["materials"][0]["alphaMode"] = "MASK";
  EXPECT_NE(
      error_of(gltf.save("bad"))
          .find("material 0, baseColorTexture: has no PNG, JPEG or WebP image but only that of KHR_texture_basisu, "
                "but shadows need its alpha"),
      std::string::npos);
}

TEST(Unlit, IsKept) {
  GltfBuilder gltf = one_triangle();
  gltf.json["materials"] = {{{"extensions", {{"KHR_materials_unlit", Json::object()}}}}, Json::object()};
  primitive(gltf)["material"] = 0;
  EXPECT_TRUE(gltf.import().materials.at(0).unlit);
  primitive(gltf)["material"] = 1;
  EXPECT_FALSE(gltf.import().materials.at(0).unlit);
}

}  // namespace
}  // namespace chandelier::baker::test
