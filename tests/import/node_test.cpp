// SPDX-License-Identifier: Apache-2.0
// The node tree: transforms, scenes, mirrored instances, cameras.
#include <gtest/gtest.h>

#include <algorithm>

#include "gltf_builder.h"

namespace chandelier::baker::test {
namespace {

glm::dvec3 moved(const MeshInstance& instance, const glm::dvec3& local) {
  return glm::dvec3(instance.world_from_local * glm::dvec4(local, 1));
}

void expect_near(const glm::dvec3& a, const glm::dvec3& b) {
  EXPECT_LT(glm::length(a - b), 1e-6) << a.x << " " << a.y << " " << a.z;
}

constexpr double sin_45 = 0.70710678118654752;  // sin and cos of 45 degrees: a quarter turn's quaternion

TEST(Node, AppliesScaleThenRotationThenTranslationUnderItsParent) {
  GltfBuilder gltf = one_triangle();
  gltf.json["nodes"] = {
      {{"children", {1}}, {"translation", {10, 0, 0}}, {"rotation", {0, 0, sin_45, sin_45}}},
      {{"mesh", 0}, {"translation", {0, 5, 0}}, {"rotation", {0, 0, sin_45, sin_45}}, {"scale", {2, 3, 4}}}};
  const Scene scene = gltf.import();
  ASSERT_EQ(scene.instances.size(), 1u);
  // (1,1,1): scaled (2,3,4), turned a quarter about z (-3,2,4), moved (-3,7,4); the parent turns it to (-7,-3,4) and
  // moves it to (3,-3,4).
  expect_near(moved(scene.instances[0], {1, 1, 1}), {3, -3, 4});
}

TEST(Node, TakesAMatrixByColumns) {
  GltfBuilder gltf = one_triangle();
  gltf.json["nodes"][0]["matrix"] = {2, 0, 0, 0, 0, 0, 3, 0, 0, -4, 0, 0, 5, 6, 7, 1};
  // x goes to (2,0,0), y to (0,0,3), z to (0,-4,0), and all moves by (5,6,7).
  expect_near(moved(gltf.import().instances.at(0), {1, 1, 1}), {7, 2, 10});
}

TEST(Node, NormalizesItsRotation) {
  GltfBuilder gltf = one_triangle();
  gltf.json["nodes"][0]["rotation"] = {0, 0, 5, 5};
  expect_near(moved(gltf.import().instances.at(0), {1, 0, 0}), {0, 1, 0});
}

TEST(Node, SharesAMeshAmongInstances) {
  GltfBuilder gltf = one_triangle();
  gltf.add_node({{"mesh", 0}, {"translation", {0, 0, 9}}});
  const pack::Contents pack = gltf.bake();
  EXPECT_EQ(pack.instances.size(), 2u);
  EXPECT_EQ(pack.batches.size(), 1u);
  EXPECT_EQ(pack.indices.size(), 3u);
  EXPECT_EQ(pack.bake_info.unique_triangles, 1u);
  EXPECT_EQ(pack.bake_info.instanced_triangles, 2u);
  EXPECT_EQ(text_of(pack, pack.instances[0].name), "triangle");
}

glm::vec3 world_vertex(const pack::Contents& pack, const pack::BatchInstance& draw, uint32_t corner) {
  const auto& rows = pack.instances[draw.instance].world_from_local;
  const uint32_t vertex = pack.indices[pack.batches[draw.batch].first_index + corner].vertex;
  const glm::vec4 p(pack.positions[vertex].position_ls, 1);
  return {glm::dot(rows[0], p), glm::dot(rows[1], p), glm::dot(rows[2], p)};
}

TEST(Node, KeepsFrontFacesCounterClockwiseUnderNegativeScale) {
  GltfBuilder gltf = one_triangle();
  gltf.json["nodes"] = Json::array();
  gltf.add_node({{"mesh", 0}});
  gltf.add_node({{"mesh", 0}, {"scale", {-1, 1, 1}}});
  gltf.add_node({{"mesh", 0}, {"scale", {-2, 1, 1}}});
  gltf.add_node({{"mesh", 0}, {"scale", {-1, -1, 1}}});  // twice mirrored is turned, not mirrored
  const pack::Contents pack = gltf.bake();
  ASSERT_EQ(pack.batch_instances.size(), 4u);
  EXPECT_EQ(pack.batches.size(), 2u);    // one reversed copy, shared by both mirrored instances
  EXPECT_EQ(pack.positions.size(), 3u);  // vertices are not copied
  for (const pack::BatchInstance& draw : pack.batch_instances) {
    const glm::vec3 a = world_vertex(pack, draw, 0), b = world_vertex(pack, draw, 1), c = world_vertex(pack, draw, 2);
    // Mirroring in x or y leaves the side that faces +z facing +z.
    EXPECT_GT(glm::cross(b - a, c - a).z, 0) << "instance " << draw.instance;
  }
  EXPECT_EQ(pack.batch_instances[0].batch, pack.batch_instances[3].batch);
  EXPECT_EQ(pack.batch_instances[1].batch, pack.batch_instances[2].batch);
}

TEST(Node, SkipsMeshesUnderScalesThatFloatsCannotDraw) {
  for (const Json& scale : {Json{0, 0, 0}, Json{1, 0, 1}, Json{1e-10, 1e-10, 1e-10}, Json{1, 1, 1e10}}) {
    GltfBuilder gltf = one_triangle();
    gltf.json["nodes"][0]["scale"] = scale;
    Warnings warnings;
    EXPECT_TRUE(gltf.import(&warnings).instances.empty());
    ASSERT_EQ(warnings.lines().size(), 1u);
    EXPECT_NE(
        warnings.lines()[0].find("node 0 'triangle': a mesh whose scale is zero or not within 1e-9 to 1e9 is skipped"),
        std::string::npos);
  }
}

TEST(Node, BakesSmallAndUnevenScales) {
  GltfBuilder gltf = one_triangle();
  gltf.json["nodes"][0]["scale"] = {1e-9, 1e-9, 1e-9};
  gltf.add_node({{"mesh", 0}, {"scale", {1000, 1, 0.01}}});
  gltf.add_node({{"mesh", 0}, {"scale", {1e9, 1e9, 1e9}}});
  const pack::Contents pack = gltf.bake();
  ASSERT_EQ(pack.batch_instances.size(), 3u);
  const glm::vec3 corners[] = {{1e-9f, 1e-9f, 0}, {1000, 1, 0}, {1e9f, 1e9f, 0}};
  for (int i = 0; i < 3; ++i) {
    EXPECT_EQ(pack.batch_instances[i].bounds_min_ws, glm::vec3(0));
    EXPECT_EQ(pack.batch_instances[i].bounds_max_ws, corners[i]) << i;
  }
}

TEST(Node, ShowsTheDefaultSceneTheFirstOrAllRoots) {
  GltfBuilder gltf = one_triangle();
  gltf.json["nodes"] = {{{"mesh", 0}, {"name", "a"}}, {{"mesh", 0}, {"name", "b"}}};
  EXPECT_EQ(gltf.import().instances.size(), 2u);
  gltf.json["scenes"] = {{{"nodes", {0}}}, {{"nodes", {1}}}};
  EXPECT_EQ(gltf.import().instances.at(0).name, "a");
  gltf.json["scene"] = 1;
  ASSERT_EQ(gltf.import().instances.size(), 1u);
  EXPECT_EQ(gltf.import().instances.at(0).name, "b");
}

/// KHR_node_visibility of a node.
Json shown(bool visible) {
  return {{"KHR_node_visibility", {{"visible", visible}}}};
}

TEST(Node, ThatIsHiddenHidesMeshesAndLightsBelowItButNoCamera) {
  GltfBuilder gltf = one_triangle();
  gltf.json["extensionsRequired"] = gltf.json["extensionsUsed"] = {"KHR_node_visibility", "KHR_lights_punctual"};
  gltf.json["extensions"]["KHR_lights_punctual"]["lights"] = {{{"type", "point"}}};
  gltf.json["cameras"] = {{{"type", "perspective"}, {"perspective", {{"yfov", 1}, {"znear", 0.1}}}}};
  gltf.json["meshes"].push_back(gltf.json["meshes"][0]);  // that only a hidden node has: with a fault that nobody meets
  gltf.json["meshes"][1]["primitives"][0]["indices"] = gltf.add_indices({0, 1, 70});
  Json lamp = shown(true);  // which does not bring it back
  lamp["KHR_lights_punctual"]["light"] = 0;
  gltf.json["nodes"] = {{{"name", "room"}, {"children", {1, 2}}},
                        {{"name", "seen"}, {"mesh", 0}, {"extensions", shown(true)}},
                        {{"name", "gone"}, {"mesh", 1}, {"children", {3, 4}}, {"extensions", shown(false)}},
                        {{"name", "lamp"}, {"extensions", lamp}},
                        {{"name", "eye"}, {"camera", 0}, {"children", {5}}},
                        {{"name", "leaf"}, {"mesh", 0}}};
  Warnings warnings;
  Scene scene = gltf.import(&warnings);
  ASSERT_EQ(scene.instances.size(), 1u);
  EXPECT_EQ(scene.instances[0].name, "seen");
  EXPECT_EQ(scene.meshes.size(), 1u);
  EXPECT_TRUE(scene.lights.empty());
  ASSERT_EQ(scene.cameras.size(), 1u);
  EXPECT_EQ(scene.cameras[0].name, "eye");
  ASSERT_EQ(warnings.lines().size(), 1u);
  EXPECT_NE(warnings.lines()[0].find("nodes: meshes and lights hidden by KHR_node_visibility are left out (node 2 "
                                     "'gone', node 3 'lamp', node 5 'leaf')"),
            std::string::npos)
      << warnings.lines()[0];
  gltf.json["nodes"][2].erase("extensions");
  EXPECT_NE(error_of(gltf.save("shown")), "");  // the fault
}

TEST(Node, ThatIsHiddenHasNoPartInWhatMoves) {
  GltfBuilder gltf = one_triangle();
  gltf.add_node({{"mesh", 0}, {"name", "gone"}, {"extensions", shown(false)}});
  gltf.add_node({{"name", "arm"}, {"children", {1}}});
  gltf.json["animations"] = {
      {{"samplers",
        {{{"input", gltf.add_floats({0, 1}, "SCALAR", 1)}, {"output", gltf.add_positions({0, 0, 0, 0, 0, 5})}}}},
       {"channels", {{{"sampler", 0}, {"target", {{"node", 2}, {"path", "translation"}}}}}}}};
  const Scene scene = gltf.import();
  ASSERT_EQ(scene.instances.size(), 1u);
  EXPECT_EQ(scene.instances[0].node, no_index);
  ASSERT_EQ(scene.nodes.size(), 1u);
  EXPECT_EQ(scene.nodes[0].name, "arm");
}

TEST(Node, WhoseVisibilityIsAnimatedStaysAsItIsWithALine) {
  GltfBuilder gltf = one_triangle();
  const std::string pointer = "/nodes/0/extensions/KHR_node_visibility/visible";
  const Json target = {{"path", "pointer"}, {"extensions", {{"KHR_animation_pointer", {{"pointer", pointer}}}}}};
  gltf.json["extensionsUsed"] = {"KHR_animation_pointer", "KHR_node_visibility"};
  gltf.json["animations"] = {
      {{"samplers",
        {{{"input", gltf.add_floats({0, 1}, "SCALAR", 1)}, {"output", gltf.add_floats({1, 0}, "SCALAR", 1)}}}},
       {"channels", {{{"sampler", 0}, {"target", target}}}}}};
  Warnings warnings;
  EXPECT_EQ(gltf.import(&warnings).instances.size(), 1u);
  const std::vector<std::string> lines = warnings.lines();
  EXPECT_TRUE(std::any_of(lines.begin(), lines.end(), [&](const std::string& line) {
    return line.find(
               "animation 0: animation by KHR_animation_pointer is skipped: the properties that it changes stay as "
               "they are (" +
               pointer + ")") != std::string::npos;
  }));
}

TEST(Node, WalksTreesOfAnyDepth) {
  GltfBuilder gltf = one_triangle();
  constexpr int depth = 20000;
  gltf.json["nodes"] = Json::array();
  for (int i = 0; i < depth; ++i) gltf.add_node({{"children", {i + 1}}, {"translation", {1, 0, 0}}});
  gltf.add_node({{"mesh", 0}});
  expect_near(moved(gltf.import().instances.at(0), {0, 0, 0}), {depth, 0, 0});
}

TEST(Node, WarnsOfASkinWithoutJointsAndIsSilentOfMorphTargetsWithoutWeights) {
  GltfBuilder gltf = one_triangle();
  gltf.json["skins"] = {{{"joints", {0}}}};
  gltf.json["nodes"][0]["skin"] = 0;
  gltf.json["meshes"][0]["primitives"][0]["targets"] = {{{"POSITION", 0}}};
  Warnings warnings;
  EXPECT_EQ(gltf.import(&warnings).instances.size(), 1u);
  EXPECT_EQ(warnings.lines().size(), 1u);
}

TEST(Camera, LooksAlongItsNodesNegativeZ) {
  GltfBuilder gltf;
  gltf.json["cameras"] = {
      {{"type", "perspective"},
       {"name", "lens"},
       {"perspective", {{"yfov", 0.5}, {"znear", 0.01}, {"aspectRatio", 2}}}},
      {{"type", "orthographic"}, {"orthographic", {{"xmag", 1}, {"ymag", 1}, {"zfar", 9}, {"znear", 1}}}}};
  // A quarter turn about y takes -z to -x.
  gltf.add_node(
      {{"camera", 0}, {"translation", {1, 2, 3}}, {"rotation", {0, sin_45, 0, sin_45}}, {"scale", {2, 2, 2}}});
  gltf.add_node({{"camera", 1}});
  Warnings warnings;
  const Scene scene = gltf.import(&warnings);
  ASSERT_EQ(scene.cameras.size(), 1u);
  EXPECT_EQ(warnings.lines().size(), 1u);
  const Camera& camera = scene.cameras[0];
  EXPECT_EQ(camera.name, "lens");
  expect_near(camera.position_ws, {1, 2, 3});
  expect_near(camera.forward_ws, {-1, 0, 0});
  expect_near(camera.up_ws, {0, 1, 0});
  EXPECT_FLOAT_EQ(camera.yfov_rad, 0.5f);
  EXPECT_FLOAT_EQ(camera.aspect, 2);
  EXPECT_FLOAT_EQ(camera.znear_m, 0.01f);
}

}  // namespace
}  // namespace chandelier::baker::test
