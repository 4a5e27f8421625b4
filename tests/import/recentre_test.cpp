// SPDX-License-Identifier: Apache-2.0
// Scenes far from the origin of their files: the pack's world begins near them, and says where.
#include "bake/recentre.h"

#include <gtest/gtest.h>

#include <array>

#include "gltf_builder.h"
#include "import/import.h"
#include "scene_origin.h"

namespace chandelier::baker::test {
namespace {

const Json far = {500000, 40, -7000};  // 40 m is near
const glm::dvec3 far_m(500000, 40, -7000);

/// A triangle, a lamp and a camera under a root node, which stands at `place`.
GltfBuilder room_at(const Json& place) {
  GltfBuilder gltf = one_triangle();
  gltf.json["extensionsUsed"] = {"KHR_lights_punctual"};
  gltf.json["extensions"]["KHR_lights_punctual"]["lights"] = {{{"type", "point"}, {"range", 9}},
                                                              {{"type", "directional"}}};
  gltf.json["cameras"] = {{{"type", "perspective"}, {"perspective", {{"yfov", 1}, {"znear", 0.1}}}}};
  gltf.json["nodes"][0]["translation"] = {0.1, 0.2, 0.3};
  gltf.json["nodes"][0]["name"] = "wall";
  const auto light = [](int number) { return Json{{"KHR_lights_punctual", {{"light", number}}}}; };
  gltf.add_node({{"name", "lamp"}, {"translation", {0.7, 2.2, 1.1}}, {"extensions", light(0)}});
  gltf.add_node({{"name", "sun"}, {"extensions", light(1)}});
  gltf.add_node({{"name", "eye"}, {"translation", {0.4, 1.6, 3.3}}, {"camera", 0}});
  gltf.add_node({{"name", "root"}, {"translation", place}, {"children", {0, 1, 2, 3}}});
  gltf.json["scenes"] = {{{"nodes", {4}}}};
  gltf.json["scene"] = 0;
  return gltf;
}

glm::dmat4 matrix_of(const std::array<glm::vec4, 3>& rows) {
  glm::dmat4 out(1);
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 4; ++column) out[column][row] = rows[row][column];
  }
  return out;
}

glm::dvec3 in_file(const pack::Contents& pack, const glm::vec3& p_ws) {
  return pack.bake_info.origin_m + glm::dvec3(p_ws);
}

void expect_near(const glm::dvec3& a, const glm::dvec3& b, double tolerance = 1e-6) {
  EXPECT_NEAR(a.x, b.x, tolerance);
  EXPECT_NEAR(a.y, b.y, tolerance);
  EXPECT_NEAR(a.z, b.z, tolerance);
}

/// The first corner of the first instance, in the file's coordinates.
glm::dvec3 first_corner(const pack::Contents& pack) {
  const glm::dvec4 local(glm::dvec3(pack.positions.at(0).position_ls), 1);
  return pack.bake_info.origin_m + glm::dvec3(matrix_of(pack.instances.at(0).world_from_local) * local);
}

std::vector<std::string> warnings_of(const GltfBuilder& gltf) {
  Warnings warnings;
  Scene scene = gltf.import(&warnings);
  PassReport pass;
  recentre(scene, pass, warnings);
  return warnings.lines();
}

TEST(SceneOrigin, IsWholeMetresAlongEachAxisThatIsFar) {
  EXPECT_EQ(pack::scene_origin({-5, 0, 0}, {5, 3, 8}), glm::dvec3(0));
  EXPECT_EQ(pack::scene_origin({500, 0, 0}, {510, 3, 8}), glm::dvec3(0));  // floats are fine there
  EXPECT_EQ(pack::scene_origin({1000, -3, -7010.5}, {1010, 3, -7000}), glm::dvec3(1005, 0, -7005));
  EXPECT_EQ(pack::scene_origin({-9000, 0, 0}, {11000, 3, 8}), glm::dvec3(0));  // nothing is won
  EXPECT_EQ(pack::scene_origin({0, 0, 0}, {20000, 3, 8}), glm::dvec3(0));
  EXPECT_EQ(pack::scene_origin({10, 0, 0}, {20000, 3, 8}), glm::dvec3(10005, 0, 0));
}

TEST(Recentre, LeavesWhatIsNearAlone) {
  const pack::Contents pack = room_at({300, 0, 0}).bake();
  EXPECT_EQ(pack.bake_info.origin_m, glm::dvec3(0));
  EXPECT_EQ(pack.lights.at(0).position_ws, glm::vec3(300.7, 2.2, 1.1));
  EXPECT_EQ(pack.instances.at(0).world_from_local[0].w, 300.1f);
}

TEST(Recentre, KeepsPlacesToTheMicrometreFiveHundredKilometresAway) {
  const pack::Contents pack = room_at(far).bake();
  EXPECT_EQ(pack.bake_info.origin_m.y, 0);
  EXPECT_LT(glm::distance(pack.bake_info.origin_m, far_m), 50);
  expect_near(first_corner(pack), far_m + glm::dvec3(0.1, 0.2, 0.3));
  expect_near(in_file(pack, pack.lights.at(0).position_ws), far_m + glm::dvec3(0.7, 2.2, 1.1), 4e-6);
  expect_near(in_file(pack, pack.lights.at(0).bounds_center_ws), far_m + glm::dvec3(0.7, 2.2, 1.1), 4e-6);
  EXPECT_EQ(pack.lights.at(1).position_ws, glm::vec3(0));  // the sun is nowhere
  expect_near(in_file(pack, pack.cameras.at(0).position_ws), far_m + glm::dvec3(0.4, 1.6, 3.3), 4e-6);
  expect_near(in_file(pack, pack.bake_info.bounds_min_ws), far_m + glm::dvec3(0.1, 0.2, 0.3), 4e-6);
  EXPECT_TRUE(warnings_of(room_at(far)).empty());
}

TEST(Recentre, MovesAllInputsAlike) {
  Scene scene;
  Warnings warnings;
  import_gltf(room_at(far).save("room"), scene, warnings);
  import_gltf(room_at({500030, 40, -7000}).save("next"), scene, warnings);
  const pack::Contents pack = bake_scene(std::move(scene), {});
  ASSERT_EQ(pack.lights.size(), 4u);
  EXPECT_NEAR(pack.bake_info.origin_m.x, 500015, 2);
  expect_near(in_file(pack, pack.lights[0].position_ws), far_m + glm::dvec3(0.7, 2.2, 1.1), 4e-6);
  expect_near(in_file(pack, pack.lights[2].position_ws), far_m + glm::dvec3(30.7, 2.2, 1.1), 4e-6);
}

/// The room, whose root an animation moves and turns.
GltfBuilder moving_room(const char* interpolation) {
  GltfBuilder gltf = room_at(far);
  const bool cubic = std::string(interpolation) == "CUBICSPLINE";
  std::vector<float> places;
  for (int key = 0; key < 2; ++key) {
    if (cubic) places.insert(places.end(), {1, 2, 3});  // tangents are speeds
    places.insert(places.end(), {500000.0f + 8.0f * static_cast<float>(key), 40, -7000});
    if (cubic) places.insert(places.end(), {4, 5, 6});
  }
  const int times = gltf.add_floats({0, 2}, "SCALAR", 1), turns = gltf.add_floats({0, 0, 0, 1, 0, 1, 0, 0}, "VEC4", 4);
  gltf.json["accessors"][times]["min"] = {0};
  gltf.json["accessors"][times]["max"] = {2};
  gltf.json["animations"] = {
      {{"samplers",
        {{{"input", times}, {"output", gltf.add_floats(places, "VEC3", 3)}, {"interpolation", interpolation}},
         {{"input", times}, {"output", turns}}}},
       {"channels",
        {{{"sampler", 0}, {"target", {{"node", 4}, {"path", "translation"}}}},
         {{"sampler", 1}, {"target", {{"node", 4}, {"path", "rotation"}}}}}}}};
  return gltf;
}

// At rest, and at each key: root · child, as a runtime poses them, is the file's less the origin.
TEST(Recentre, MovesARootThatIsAnimatedAtAnyTime) {
  for (const char* interpolation : {"LINEAR", "STEP", "CUBICSPLINE"}) {
    const pack::Contents pack = moving_room(interpolation).bake();
    ASSERT_EQ(pack.bake_info.origin_m.y, 0);
    ASSERT_GT(pack.bake_info.origin_m.x, 499000);
    ASSERT_EQ(text_of(pack, pack.nodes.at(0).name), "root");
    const pack::Node& root = pack.nodes[0];
    expect_near(in_file(pack, root.translation), far_m);
    expect_near(pack.bake_info.origin_m + glm::dvec3(matrix_of(root.parent_from_local)[3]), far_m);
    const pack::AnimationChannel& moves = pack.animation_channels.at(0);
    ASSERT_EQ(moves.path, pack::AnimationPath::translation);
    const auto value = [&](uint32_t i) {
      const auto* v = &pack.animation_values.at(moves.first_value + 3 * i);
      return glm::vec3(v[0].value, v[1].value, v[2].value);
    };
    const bool cubic = moves.value_count == 18;
    for (uint32_t key = 0; key < 2; ++key) {
      expect_near(in_file(pack, value(cubic ? 3 * key + 1 : key)), far_m + glm::dvec3(8 * key, 0, 0));
      if (cubic) {
        EXPECT_EQ(value(3 * key), glm::vec3(1, 2, 3));
        EXPECT_EQ(value(3 * key + 2), glm::vec3(4, 5, 6));
      }
    }
    for (const pack::Node& node : pack.nodes) {
      if (text_of(pack, node.name) != "wall") continue;
      EXPECT_EQ(node.translation, glm::vec3(0.1, 0.2, 0.3));
    }
    expect_near(first_corner(pack), far_m + glm::dvec3(0.1, 0.2, 0.3));
  }
}

// The rest pose of each joint, times its bind matrix, is the file's less the origin; so is the instance's place.
TEST(Recentre, MovesJointsWithTheirSkin) {
  GltfBuilder gltf = room_at(far);
  gltf.json["nodes"][0]["skin"] = 0;
  gltf.add_node({{"name", "joint"}, {"translation", {0, 7, 0}}});
  gltf.json["nodes"][4]["children"].push_back(5);
  gltf.json["skins"] = {
      {{"joints", {5}},
       {"inverseBindMatrices", gltf.add_floats({1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0.5f, -7, 0, 1}, "MAT4", 16)}}};
  Json& attributes = gltf.json["meshes"][0]["primitives"][0]["attributes"];
  attributes["JOINTS_0"] =
      gltf.add_accessor<uint8_t>({0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0}, unsigned_byte_type, "VEC4", 3);
  attributes["WEIGHTS_0"] = gltf.add_floats({1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0}, "VEC4", 4);
  const glm::dvec3 expected = far_m + glm::dvec3(0.5, 0, 0);
  expect_near(first_corner(gltf.bake()), expected);  // it stands still: posed at bake
  const int times = gltf.add_floats({0, 2}, "SCALAR", 1);
  gltf.json["accessors"][times]["min"] = {0};
  gltf.json["accessors"][times]["max"] = {2};
  gltf.json["animations"] = {
      {{"samplers", {{{"input", times}, {"output", gltf.add_floats({0, 0, 0, 1, 0, 0, 0, 1}, "VEC4", 4)}}}},
       {"channels", {{{"sampler", 0}, {"target", {{"node", 5}, {"path", "rotation"}}}}}}}};
  const pack::Contents pack = gltf.bake();
  ASSERT_EQ(pack.joints.size(), 1u);
  expect_near(first_corner(pack), expected);
  glm::dmat4 world(1);
  for (uint32_t node = pack.joints[0].node; node != pack::none; node = pack.nodes[node].parent)
    world = matrix_of(pack.nodes[node].parent_from_local) * world;
  const glm::dmat4 posed = world * matrix_of(pack.joints[0].joint_from_bind);
  expect_near(pack.bake_info.origin_m + glm::dvec3(posed[3]), expected);
}

/// A triangle of 4 m whose vertices, not its node, are far away; a second node shows it turned and mirrored.
GltfBuilder far_vertices(float x) {
  GltfBuilder gltf = one_triangle();
  gltf.json["meshes"][0]["primitives"][0]["attributes"]["POSITION"] =
      gltf.add_positions({x, 0, 0, x + 4, 0, 0, x, 4, 0});
  gltf.add_node(
      {{"mesh", 0}, {"rotation", {0, 0, 0.70710678, 0.70710678}}, {"scale", {-1, 1, 1}}, {"translation", {0, x, 0}}});
  return gltf;
}

TEST(Recentre, MovesVerticesThatAreFarFromTheirMeshsOrigin) {
  const pack::Contents pack = far_vertices(8000).bake();
  for (const pack::Position& each : pack.positions) EXPECT_LT(glm::length(each.position_ls), 10);
  const Scene before = far_vertices(8000).import();
  ASSERT_EQ(pack.instances.size(), 2u);
  for (size_t i = 0; i < 2; ++i) {
    glm::dvec3 low(INFINITY), expected(INFINITY);
    for (const Vertex& vertex : before.meshes[0].primitives[0].vertices)
      expected =
          glm::min(expected, glm::dvec3(before.instances[i].world_from_local * glm::dvec4(vertex.position_ls, 1)));
    for (const pack::Position& each : pack.positions)
      low = glm::min(low, glm::dvec3(matrix_of(pack.instances[i].world_from_local) * glm::dvec4(each.position_ls, 1)));
    expect_near(pack.bake_info.origin_m + low, expected, 1e-3);
  }
  EXPECT_TRUE(warnings_of(far_vertices(8000)).empty());
}

TEST(Recentre, WarnsOnceOfWhatTheFilesFloatsHaveRounded) {
  const auto lines = warnings_of(far_vertices(500000));
  ASSERT_EQ(lines.size(), 1u);
  EXPECT_NE(lines[0].find("floats are up to 31.3 mm apart"), std::string::npos) << lines[0];

  // Node by node, as exporters write floats: 2.2 m and 0.7 m up and aside have become multiples of 1/32 m.
  GltfBuilder rounded = one_triangle();
  rounded.json["nodes"][0]["translation"] = {double{500000.7f}, 0, 0};
  rounded.json["nodes"][0]["name"] = "wall";
  EXPECT_EQ(warnings_of(rounded).size(), 1u);
  rounded.add_node({{"mesh", 0}, {"translation", {double{500003.4f}, 0, 0}}, {"children", {2}}});
  rounded.add_node({{"mesh", 0}, {"translation", {0.1, 0, 0}}});  // hangs from it, and is no float
  const auto parented = warnings_of(rounded);
  ASSERT_EQ(parented.size(), 1u);
  EXPECT_NE(parented[0].find("(wall, "), std::string::npos) << parented[0];
  EXPECT_EQ(parented[0].find("node 2"), std::string::npos) << parented[0];
  rounded.json["nodes"].erase(1);
  rounded.json["nodes"].erase(1);
  rounded.json["nodes"][0]["translation"] = {500000.7, 0, 0};  // a double: it can be had
  EXPECT_TRUE(warnings_of(rounded).empty());
  rounded.json["nodes"][0]["translation"] = {500000, 0, 0};  // meant so
  EXPECT_TRUE(warnings_of(rounded).empty());
}

}  // namespace
}  // namespace chandelier::baker::test
