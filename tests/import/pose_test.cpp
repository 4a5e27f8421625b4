// SPDX-License-Identifier: Apache-2.0
// Shapes that a file itself has: morph targets with their weights, and skins that nothing moves.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>

#include "gltf_builder.h"

namespace chandelier::baker::test {
namespace {

constexpr double sin_45 = 0.70710678118654752;  // of a quarter turn's quaternion

Json& primitive(GltfBuilder& gltf) {
  return gltf.json["meshes"][0]["primitives"][0];
}

const Primitive& first(const Scene& scene, size_t mesh = 0) {
  return scene.meshes.at(mesh).primitives.at(0);
}

/// The triangle with two targets: one lifts it by 2, the other stretches its second corner along x by 4.
GltfBuilder morphed_triangle() {
  GltfBuilder gltf = one_triangle();
  const int lift = gltf.add_positions({0, 0, 2, 0, 0, 2, 0, 0, 2});
  const int stretch = gltf.add_positions({0, 0, 0, 4, 0, 0, 0, 0, 0});
  primitive(gltf)["targets"] = {{{"POSITION", lift}}, {{"POSITION", stretch}}};
  return gltf;
}

void expect_near(const glm::vec3& found, const glm::vec3& expected, float tolerance = 1e-6f) {
  EXPECT_NEAR(glm::distance(found, expected), 0, tolerance) << found.x << " " << found.y << " " << found.z;
}

void expect_positions(const Primitive& primitive, const std::vector<glm::vec3>& expected) {
  ASSERT_EQ(primitive.vertices.size(), expected.size());
  for (size_t i = 0; i < expected.size(); ++i) expect_near(primitive.vertices[i].position_ls, expected[i]);
}

TEST(Morph, FollowsTheMeshsWeights) {
  GltfBuilder gltf = morphed_triangle();
  gltf.json["meshes"][0]["weights"] = {0.5, 0.25};
  Warnings warnings;
  expect_positions(first(gltf.import(&warnings)), {{0, 0, 1}, {2, 0, 1}, {0, 1, 1}});
  EXPECT_TRUE(warnings.lines().empty());
}

TEST(Morph, PrefersTheNodesWeights) {
  GltfBuilder gltf = morphed_triangle();
  gltf.json["meshes"][0]["weights"] = {1, 0};
  gltf.json["nodes"][0]["weights"] = {0, -1};
  expect_positions(first(gltf.import()), {{0, 0, 0}, {-3, 0, 0}, {0, 1, 0}});
}

TEST(Morph, WithoutWeightsIsTheBaseMeshWhateverItsTargetsAre) {
  GltfBuilder gltf = morphed_triangle();
  primitive(gltf)["targets"].push_back({{"POSITION", gltf.add_positions({0, 0, 0})}});  // too few, but not read
  expect_positions(first(gltf.import()), {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}});
  gltf.json["meshes"][0]["weights"] = {0, 0};
  expect_positions(first(gltf.import()), {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}});
}

TEST(Morph, NodesShareAMeshWhereTheirWeightsAreTheSame) {
  GltfBuilder gltf = morphed_triangle();
  gltf.json["nodes"][0]["weights"] = {1, 0};
  gltf.add_node({{"mesh", 0}, {"weights", {0, 1}}});
  gltf.add_node({{"mesh", 0}, {"weights", {1, 0}}});
  gltf.add_node({{"mesh", 0}});
  gltf.add_node({{"mesh", 0}, {"weights", {0, 0}}});
  const Scene scene = gltf.import();
  ASSERT_EQ(scene.meshes.size(), 3u);
  ASSERT_EQ(scene.instances.size(), 5u);
  EXPECT_EQ(scene.instances[0].mesh, scene.instances[2].mesh);
  EXPECT_EQ(scene.instances[3].mesh, scene.instances[4].mesh);
  EXPECT_EQ(first(scene, scene.instances[0].mesh).vertices[0].position_ls.z, 2);
  EXPECT_EQ(first(scene, scene.instances[1].mesh).vertices[1].position_ls.x, 5);
  EXPECT_EQ(first(scene, scene.instances[3].mesh).vertices[1].position_ls, glm::vec3(1, 0, 0));
}

/// The second corner alone, in an accessor that has nothing but sparse values.
TEST(Morph, ReadsSparseTargets) {
  GltfBuilder gltf = morphed_triangle();
  const int indices = gltf.add_view<uint16_t>({1}), values = gltf.add_view<float>({0, 3, 0});
  const int sparse =
      gltf.append("accessors", {{"componentType", float_type},
                                {"type", "VEC3"},
                                {"count", 3},
                                {"min", {0, 0, 0}},
                                {"max", {0, 3, 0}},
                                {"sparse",
                                 {{"count", 1},
                                  {"indices", {{"bufferView", indices}, {"componentType", unsigned_short_type}}},
                                  {"values", {{"bufferView", values}}}}}});
  primitive(gltf)["targets"] = {{{"POSITION", sparse}}};
  gltf.json["meshes"][0]["weights"] = {0.5};
  expect_positions(first(gltf.import()), {{0, 0, 0}, {1, 1.5f, 0}, {0, 1, 0}});
}

TEST(Morph, ReadsQuantizedTargets) {
  GltfBuilder gltf = morphed_triangle();
  gltf.json["extensionsUsed"] = gltf.json["extensionsRequired"] = {"KHR_mesh_quantization"};
  const int view = gltf.add_view<int16_t>({0, 0, 0, 0, 32767, 0, -16384, 0, 0, 0, 0, 0}, 8);
  Json accessor = {
      {"bufferView", view}, {"componentType", short_type}, {"type", "VEC3"}, {"count", 3}, {"normalized", true}};
  primitive(gltf)["targets"] = {{{"POSITION", gltf.append("accessors", accessor)}}};
  gltf.json["meshes"][0]["weights"] = {2};
  expect_positions(first(gltf.import()), {{0, 0, 0}, {3, 0, -2.0f * 16384 / 32767}, {0, 1, 0}});
}

TEST(Morph, TurnsNormalsAndTangents) {
  GltfBuilder gltf = morphed_triangle();
  primitive(gltf)["attributes"]["NORMAL"] = gltf.add_floats({0, 0, 1, 0, 0, 1, 0, 0, 1}, "VEC3", 3);
  primitive(gltf)["attributes"]["TANGENT"] = gltf.add_floats({1, 0, 0, -1, 1, 0, 0, -1, 1, 0, 0, -1}, "VEC4", 4);
  primitive(gltf)["targets"] = {{{"NORMAL", gltf.add_floats({1, 0, 0, 0, 0, 0, 0, 0, -1}, "VEC3", 3)},
                                 {"TANGENT", gltf.add_floats({0, 0, -1, 0, 0, 0, 0, 0, 0}, "VEC3", 3)}}};
  gltf.json["meshes"][0]["weights"] = {1};
  const Scene scene = gltf.import();
  const std::vector<Vertex>& vertices = first(scene).vertices;
  const auto half = static_cast<float>(sin_45);
  expect_near(vertices[0].normal_ls, {half, 0, half});
  expect_near(glm::vec3(vertices[0].tangent_ls), {half, 0, -half});
  EXPECT_EQ(vertices[0].tangent_ls.w, -1);
  expect_near(vertices[1].normal_ls, {0, 0, 1});
  expect_near(vertices[2].normal_ls, {0, 0, 1});  // nothing is left of it: that of its triangle
}

TEST(Morph, LeavesNormalsThatTheFileLacksToTheShapeThatItMakes) {
  GltfBuilder gltf = morphed_triangle();
  primitive(gltf)["targets"] = {{{"POSITION", gltf.add_positions({0, 0, 0, 0, 0, 0, 0, -1, 1})}}};
  gltf.json["meshes"][0]["weights"] = {1};
  const Scene scene = gltf.import();
  EXPECT_TRUE(first(scene).needs_normals);
  const pack::Contents pack = gltf.bake();  // it stands upright now, its front to -y
  EXPECT_EQ(pack.bake_info.bounds_max_ws, glm::vec3(1, 0, 1));
}

TEST(Morph, SaysWhichAttributesItLeaves) {
  GltfBuilder gltf = morphed_triangle();
  primitive(gltf)["attributes"]["TEXCOORD_0"] = gltf.add_floats({0, 0, 1, 0, 0, 1}, "VEC2", 2);
  primitive(gltf)["targets"][0]["TEXCOORD_0"] = gltf.add_floats({0, 0, 1, 0, 0, 1}, "VEC2", 2);
  gltf.json["meshes"][0]["weights"] = {1, 0};
  Warnings warnings;
  gltf.import(&warnings);
  ASSERT_EQ(warnings.lines().size(), 1u);
  EXPECT_NE(warnings.lines()[0].find("morph targets of TEXCOORD_0 are ignored"), std::string::npos);
}

struct Case {
  const char* name;
  std::function<void(GltfBuilder&)> spoil;
  const char* expected;
};

void expect_errors(GltfBuilder (*make)(), std::initializer_list<Case> cases) {
  for (const Case& each : cases) {
    GltfBuilder gltf = make();
    each.spoil(gltf);
    const std::filesystem::path path = gltf.save("bad");
    EXPECT_EQ(error_of(path), path.string() + ": " + each.expected) << each.name;
  }
}

void set_target(GltfBuilder& gltf, int accessor) {
  primitive(gltf)["targets"][0]["POSITION"] = accessor;
}

TEST(Morph, IsRefusedWhereItsShapeIsNotKnown) {
  constexpr float not_a_number = std::numeric_limits<float>::quiet_NaN();
  expect_errors(
      [] {
        GltfBuilder gltf = morphed_triangle();
        gltf.json["meshes"][0]["weights"] = {1, 0.5};
        return gltf;
      },
      {{"few weights", [](GltfBuilder& g) { g.json["meshes"][0]["weights"] = {1}; },
        "mesh 0, primitive 0: has a different number of morph targets than of weights, which are 1 (2)"},
       {"many weights of the node",
        [](GltfBuilder& g) {
          g.json["nodes"][0]["weights"] = {1, 2, 3};
        },
        "mesh 0, primitive 0: has a different number of morph targets than of weights, which are 3 (2)"},
       {"weights that are none", [](GltfBuilder& g) { g.json["meshes"][0]["weights"] = "all"; },
        "mesh 0, weights: is not an array (\"all\")"},
       {"a weight that is no number",
        [](GltfBuilder& g) {
          g.json["nodes"][0]["weights"] = {1, true};
        },
        "node 0 'triangle', weights: is not a number (true)"},
       {"a weight beyond a float",
        [](GltfBuilder& g) {
          g.json["nodes"][0]["weights"] = {1, 1e39};
        },
        "node 0 'triangle', weights: is out of range (1e+39)"},
       {"a target that is none", [](GltfBuilder& g) { primitive(g)["targets"][0] = 5; },
        "mesh 0, primitive 0, target 0: is not an object (5)"},
       {"a target past the end", [](GltfBuilder& g) { set_target(g, 99); },
        "mesh 0, primitive 0, target 0, POSITION: points past the end, there are 4 (99)"},
       {"another count",
        [](GltfBuilder& g) {
          set_target(g, g.add_positions({0, 0, 0}));
        },
        "mesh 0, primitive 0, morph target 0, POSITION: has a different number of elements than POSITION, which has 3 "
        "(1)"},
       {"another type",
        [](GltfBuilder& g) {
          set_target(g, g.add_floats({0, 0, 0, 0, 0, 0}, "VEC2", 2));
        },
        "mesh 0, primitive 0, morph target 0, POSITION: accessor 4 has the wrong type (2 components)"},
       {"no number",
        [](GltfBuilder& g) {
          set_target(g, g.add_floats({0, 0, 0, 0, not_a_number, 0, 0, 0, 0}, "VEC3", 3));
        },
        "mesh 0, primitive 0, morph target 0, POSITION: value is not finite (nan in element 1)"},
       {"beyond a float",
        [](GltfBuilder& g) {
          g.json["meshes"][0]["weights"] = {1e30, 0};
          set_target(g, g.add_floats({0, 0, 0, 0, 0, 0, 1e30f, 0, 0}, "VEC3", 3));
        },
        "mesh 0, primitive 0, attribute POSITION: its morph targets move it to a position that is too large for a "
        "float (element 2)"}});
}

/// A thousand targets of one accessor of four million zeros: 4 GiB of sums for 30 kB of JSON.
TEST(Morph, IsRefusedWhereItAsksForTooMuchBeforeAnythingIsRead) {
  GltfBuilder gltf = one_triangle();
  const int zeros = gltf.append("accessors", {{"componentType", float_type}, {"type", "VEC3"}, {"count", 4194304}});
  for (int i = 0; i < 1000; ++i) {
    primitive(gltf)["targets"].push_back({{"POSITION", zeros}});
    gltf.json["meshes"][0]["weights"].push_back(1);
  }
  const std::filesystem::path path = gltf.save("large");
  EXPECT_EQ(error_of(path), path.string() +
                                ": mesh 0, primitive 0: the morph targets up to here have more than 1073741824 "
                                "vertices (4194304000)");
}

/// A triangle in the plane z = 0 with normals of its own; two joints: node 1, at x = 5, and node 2, which hangs from
/// it. The first two corners are node 1's, the third is node 2's. In the bind pose the joints stand at 0 and at y = 1.
GltfBuilder posed_triangle() {
  GltfBuilder gltf = one_triangle();
  gltf.json["nodes"][0]["translation"] = {50, 0, 0};  // which counts for nothing
  gltf.json["nodes"][0]["skin"] = 0;
  gltf.add_node({{"name", "hip"}, {"children", {2}}, {"translation", {5, 0, 0}}});
  gltf.add_node({{"name", "knee"}, {"translation", {0, 1, 0}}});
  std::vector<float> matrices;
  for (int i = 0; i < 2; ++i) {
    matrices.insert(matrices.end(), {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, -static_cast<float>(i), 0, 1});
  }
  gltf.json["skins"] = {
      {{"name", "leg"}, {"joints", {1, 2}}, {"inverseBindMatrices", gltf.add_floats(matrices, "MAT4", 16)}}};
  Json& attributes = primitive(gltf)["attributes"];
  attributes["NORMAL"] = gltf.add_floats({0, 0, 1, 0, 0, 1, 0, 0, 1}, "VEC3", 3);
  attributes["JOINTS_0"] =
      gltf.add_accessor<uint8_t>({0, 0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0}, unsigned_byte_type, "VEC4", 3);
  attributes["WEIGHTS_0"] = gltf.add_floats({1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0}, "VEC4", 4);
  return gltf;
}

/// Where the corners of a scene's first instance stand.
std::vector<glm::dvec3> corners_ws(const Scene& scene) {
  std::vector<glm::dvec3> out;
  for (const Vertex& vertex : first(scene).vertices) {
    out.emplace_back(scene.instances.at(0).world_from_local * glm::dvec4(vertex.position_ls, 1));
  }
  return out;
}

glm::vec3 front_of(const Primitive& primitive) {
  const auto corner = [&](size_t i) { return primitive.vertices[primitive.indices[i]].position_ls; };
  return glm::normalize(glm::cross(corner(1) - corner(0), corner(2) - corner(0)));
}

TEST(PosedSkin, IsBakedAsStaticGeometryWhereItsJointsHaveIt) {
  GltfBuilder gltf = posed_triangle();
  gltf.json["nodes"][2]["translation"] = {0, 1, 3};
  Warnings warnings;
  const Scene scene = gltf.import(&warnings);
  EXPECT_TRUE(warnings.lines().empty());
  const auto corners = corners_ws(scene);
  expect_near(corners[0], {5, 0, 0});
  expect_near(corners[1], {6, 0, 0});
  expect_near(corners[2], {5, 1, 3});
  EXPECT_TRUE(first(scene).skin_vertices.empty());
  EXPECT_TRUE(scene.nodes.empty());
  const pack::Contents pack = gltf.bake();
  ASSERT_EQ(pack.instances.size(), 1u);
  EXPECT_EQ(pack.instances[0].dynamic, 0u);
  EXPECT_EQ(pack.instances[0].skin, pack::none);
  EXPECT_TRUE(pack.skins.empty());
  EXPECT_EQ(pack.batch_bvh_items.size(), 1u);
  EXPECT_EQ(pack.bake_info.bounds_max_ws, glm::vec3(6, 1, 3));
}

/// A quarter turn of the knee about x takes z to -y, and half a turn of normals goes with it.
TEST(PosedSkin, TurnsNormals) {
  GltfBuilder gltf = posed_triangle();
  gltf.json["nodes"][2]["rotation"] = {sin_45, 0, 0, sin_45};
  const Scene scene = gltf.import();
  expect_near(first(scene).vertices[0].normal_ls, {0, 0, 1});
  expect_near(first(scene).vertices[2].normal_ls, {0, -1, 0});
}

/// Stretched along z by 4, a normal of (0, 1, 1) / √2 becomes (0, 1, 1/4).
TEST(PosedSkin, TakesNormalsThroughTheInverseTranspose) {
  GltfBuilder gltf = posed_triangle();
  const auto half = static_cast<float>(sin_45);
  primitive(gltf)["attributes"]["NORMAL"] = gltf.add_floats({0, half, half, 0, half, half, 0, half, half}, "VEC3", 3);
  gltf.json["nodes"][1]["scale"] = {1, 1, 4};
  expect_near(first(gltf.import()).vertices[0].normal_ls, glm::normalize(glm::vec3(0, 1, 0.25f)));
}

TEST(PosedSkin, KeepsFrontsInFrontWhereAJointMirrors) {
  GltfBuilder gltf = posed_triangle();
  primitive(gltf)["attributes"]["TANGENT"] = gltf.add_floats({1, 0, 0, 1, 1, 0, 0, 1, 1, 0, 0, 1}, "VEC4", 4);
  expect_near(front_of(first(gltf.import())), {0, 0, 1});
  gltf.json["nodes"][1]["scale"] = {-1, 1, 1};
  const Scene scene = gltf.import();
  expect_near(front_of(first(scene)), {0, 0, 1});
  expect_near(first(scene).vertices[0].normal_ls, {0, 0, 1});
  expect_near(glm::vec3(first(scene).vertices[0].tangent_ls), {-1, 0, 0});
  EXPECT_EQ(first(scene).vertices[0].tangent_ls.w, -1);
  gltf.json["nodes"][1]["scale"] = {1, 1, -1};  // turned inside out along z: what looked to +z looks to -z
  const Scene flipped = gltf.import();
  expect_near(front_of(first(flipped)), {0, 0, -1});
  expect_near(first(flipped).vertices[0].normal_ls, {0, 0, -1});
}

/// Half of each joint: in the middle between where either has it.
TEST(PosedSkin, BlendsItsJoints) {
  GltfBuilder gltf = posed_triangle();
  primitive(gltf)["attributes"]["JOINTS_0"] =
      gltf.add_accessor<uint8_t>({0, 0, 0, 0, 0, 0, 0, 0, 0, 1, 0, 0}, unsigned_byte_type, "VEC4", 3);
  primitive(gltf)["attributes"]["WEIGHTS_0"] =
      gltf.add_floats({1, 0, 0, 0, 1, 0, 0, 0, 2, 2, 0, 0}, "VEC4", 4);  // which sum to 4
  gltf.json["nodes"][2]["translation"] = {0, 1, 3};
  Warnings warnings;
  const auto corners = corners_ws(gltf.import(&warnings));
  expect_near(corners[2], {5, 1, 1.5f}, 1e-4f);
  ASSERT_EQ(warnings.lines().size(), 1u);
  EXPECT_NE(warnings.lines()[0].find("weights that do not sum to 1 are scaled"), std::string::npos);
}

/// A float near 5 million is off by a quarter.
TEST(PosedSkin, KeepsItsShapeFarFromTheOrigin) {
  GltfBuilder gltf = posed_triangle();
  gltf.json["nodes"][1]["translation"] = {5e6, 0, 0};
  gltf.json["nodes"][2]["translation"] = {0.0625, 1, 0.0625};
  const auto corners = corners_ws(gltf.import());
  EXPECT_NEAR(corners[1].x, 5e6 + 1, 1e-6);
  EXPECT_NEAR(corners[2].x, 5e6 + 0.0625, 1e-6);
}

TEST(PosedSkin, IsMorphedFirst) {
  GltfBuilder gltf = posed_triangle();
  primitive(gltf)["targets"] = {{{"POSITION", gltf.add_positions({0, 0, 0, 0, 0, 0, 0, 0, 2})}}};
  gltf.json["nodes"][0]["weights"] = {1};
  gltf.json["nodes"][2]["rotation"] = {sin_45, 0, 0, sin_45};  // z to -y
  expect_near(corners_ws(gltf.import())[2], {5, -1, 0});
}

TEST(PosedSkin, IsSharedByNodesAndApartFromTheBareMesh) {
  GltfBuilder gltf = posed_triangle();
  gltf.add_node({{"mesh", 0}, {"skin", 0}, {"translation", {0, 9, 0}}});
  gltf.add_node({{"mesh", 0}, {"translation", {0, 9, 0}}});
  const Scene scene = gltf.import();
  ASSERT_EQ(scene.meshes.size(), 2u);
  ASSERT_EQ(scene.instances.size(), 3u);
  EXPECT_EQ(scene.instances[0].mesh, scene.instances[1].mesh);
  EXPECT_EQ(scene.instances[0].world_from_local, scene.instances[1].world_from_local);
  EXPECT_EQ(scene.instances[2].world_from_local[3][1], 9);
  EXPECT_EQ(first(scene, scene.instances[2].mesh).vertices[1].position_ls, glm::vec3(1, 0, 0));
}

TEST(PosedSkin, IsRefusedWhereItCannotBeWorkedOut) {
  expect_errors([] { return posed_triangle(); },
                {{"joint that the skin lacks", [](GltfBuilder& g) { g.json["skins"][0]["joints"] = {1}; },
                  "node 0 'triangle': its mesh uses joints that its skin lacks; the skin's number of joints is 1 (1)"},
                 {"beyond a float",
                  [](GltfBuilder& g) {
                    std::vector<float> matrices(32, 0);
                    for (const int i : {0, 5, 10, 15}) matrices[i] = matrices[16 + i] = i == 15 ? 1 : 1e30f;
                    g.json["skins"][0]["inverseBindMatrices"] = g.add_floats(matrices, "MAT4", 16);
                    g.json["nodes"][1]["scale"] = {1e30, 1, 1};
                  },
                  "mesh 0: its skin moves a vertex to a position that is too large for a float (vertex 1)"}});
}

}  // namespace
}  // namespace chandelier::baker::test
