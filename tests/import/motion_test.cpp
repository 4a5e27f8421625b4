// SPDX-License-Identifier: Apache-2.0
// Animations, skins, and which nodes of a scene they take along into the pack.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "gltf_builder.h"
#include "import/skin_vertices.h"

namespace chandelier::baker::test {
namespace {

/// Node 0 "triangle" has the mesh; node 1 "arm" is above it; node 2 "still" has the mesh too.
GltfBuilder moving_triangle(const char* path = "rotation", const char* interpolation = "LINEAR") {
  GltfBuilder gltf = one_triangle();
  gltf.add_node({{"name", "arm"}, {"children", {0}}, {"translation", {1, 2, 3}}});
  gltf.add_node({{"name", "still"}, {"mesh", 0}});
  const bool rotation = std::string(path) == "rotation", cubic = std::string(interpolation) == "CUBICSPLINE";
  std::vector<float> values;
  for (int i = 0; i < (cubic ? 6 : 2); ++i) {
    if (rotation) values.insert(values.end(), {0, 0, 0, 1});
    if (!rotation) values.insert(values.end(), {static_cast<float>(i), 0, 0});
  }
  const int times = gltf.add_floats({0.5f, 2}, "SCALAR", 1);
  gltf.json["accessors"][times]["min"] = {0.5};
  gltf.json["accessors"][times]["max"] = {2};
  const int output = gltf.add_floats(values, rotation ? "VEC4" : "VEC3", rotation ? 4 : 3);
  gltf.json["animations"] = {{{"name", "wave"},
                              {"samplers", {{{"input", times}, {"output", output}, {"interpolation", interpolation}}}},
                              {"channels", {{{"sampler", 0}, {"target", {{"node", 1}, {"path", path}}}}}}}};
  return gltf;
}

TEST(Animation, TakesItsNodesAndWhatTheyCarryIntoThePack) {
  const pack::Contents pack = moving_triangle().bake();
  ASSERT_EQ(pack.nodes.size(), 2u);  // not "still"
  EXPECT_EQ(text_of(pack, pack.nodes[0].name), "arm");
  EXPECT_EQ(pack.nodes[0].parent, pack::none);
  EXPECT_EQ(pack.nodes[0].translation, glm::vec3(1, 2, 3));
  EXPECT_EQ(pack.nodes[0].parent_from_local[1].w, 2);
  EXPECT_EQ(pack.nodes[1].parent, 0u);
  ASSERT_EQ(pack.instances.size(), 2u);
  for (const pack::Instance& instance : pack.instances) {
    const bool still = text_of(pack, instance.name) == "still";
    EXPECT_EQ(instance.dynamic, still ? 0u : 1u);
    EXPECT_EQ(instance.node, still ? pack::none : 1u);
    EXPECT_EQ(instance.skin, pack::none);
  }
  ASSERT_EQ(pack.animations.size(), 1u);
  EXPECT_EQ(text_of(pack, pack.animations[0].name), "wave");
  EXPECT_EQ(pack.animations[0].duration_s, 2);
  ASSERT_EQ(pack.animation_channels.size(), 1u);
  EXPECT_EQ(pack.animation_channels[0].node, 0u);
  EXPECT_EQ(pack.animation_channels[0].path, pack::AnimationPath::rotation);
  EXPECT_EQ(pack.animation_channels[0].key_count, 2u);
  EXPECT_EQ(pack.animation_channels[0].value_count, 8u);
  EXPECT_EQ(pack.animation_times.at(1).time_s, 2);
}

TEST(Animation, KeepsEachPathAndInterpolation) {
  const struct {
    const char* name;
    pack::Interpolation value;
  } interpolations[] = {{"LINEAR", pack::Interpolation::linear},
                        {"STEP", pack::Interpolation::step},
                        {"CUBICSPLINE", pack::Interpolation::cubic_spline}};
  for (const auto& interpolation : interpolations) {
    for (const char* path : {"translation", "rotation", "scale"}) {
      const pack::Contents pack = moving_triangle(path, interpolation.name).bake();
      ASSERT_EQ(pack.animation_channels.size(), 1u);
      EXPECT_EQ(pack.animation_channels[0].interpolation, interpolation.value);
      const bool cubic = interpolation.value == pack::Interpolation::cubic_spline;
      EXPECT_EQ(pack.animation_channels[0].value_count, (path[0] == 'r' ? 4u : 3u) * (cubic ? 6 : 2));
    }
  }
}

TEST(Animation, MovesLightsAndCamerasToo) {
  GltfBuilder gltf = moving_triangle();
  gltf.json["extensionsUsed"] = {"KHR_lights_punctual"};
  gltf.json["extensions"]["KHR_lights_punctual"]["lights"] = {{{"type", "point"}}};
  gltf.json["cameras"] = {{{"type", "perspective"}, {"perspective", {{"yfov", 1}, {"znear", 0.1}}}}};
  gltf.json["nodes"][0]["extensions"]["KHR_lights_punctual"]["light"] = 0;
  gltf.json["nodes"][0]["camera"] = 0;
  gltf.json["nodes"][2]["extensions"]["KHR_lights_punctual"]["light"] = 0;
  const Scene scene = gltf.import();
  ASSERT_EQ(scene.lights.size(), 2u);
  EXPECT_EQ(scene.lights[0].node, 1u);
  EXPECT_TRUE(scene.lights[0].dynamic);
  EXPECT_EQ(scene.lights[1].node, no_index);
  EXPECT_FALSE(scene.lights[1].dynamic);
  EXPECT_EQ(scene.cameras.at(0).node, 1u);
}

TEST(Animation, SkipsMorphWeightsWithAWarning) {
  GltfBuilder gltf = moving_triangle();
  gltf.json["animations"][0]["channels"][0]["target"]["path"] = "weights";
  Warnings warnings;
  const Scene scene = gltf.import(&warnings);
  EXPECT_TRUE(scene.animations.empty());
  EXPECT_TRUE(scene.nodes.empty());
  ASSERT_EQ(warnings.lines().size(), 1u);
  EXPECT_NE(warnings.lines()[0].find("animation of something other than a node's transform is skipped (weights)"),
            std::string::npos);
}

TEST(Animation, MakesRotationsUnitLengthWithAWarning) {
  GltfBuilder gltf = moving_triangle();
  const int output = gltf.add_floats({0, 0, 0, 2, 0, 3, 0, 0}, "VEC4", 4);
  gltf.json["animations"][0]["samplers"][0]["output"] = output;
  Warnings warnings;
  const Scene scene = gltf.import(&warnings);
  EXPECT_EQ(scene.animations.at(0).channels.at(0).values, (std::vector<float>{0, 0, 0, 1, 0, 1, 0, 0}));
  EXPECT_EQ(warnings.lines().size(), 1u);
}

/// The triangle with two joints: node 1 and node 2, which hangs from it and is animated; the mesh's own node is
/// elsewhere.
GltfBuilder skinned_triangle() {
  GltfBuilder gltf = one_triangle();
  gltf.json["nodes"][0]["translation"] = {50, 0, 0};
  gltf.json["nodes"][0]["skin"] = 0;
  gltf.add_node({{"name", "hip"}, {"children", {2}}, {"translation", {0, 7, 0}}});
  gltf.add_node({{"name", "knee"}, {"translation", {0, 1, 0}}});
  std::vector<float> matrices;
  for (int i = 0; i < 2; ++i) {
    matrices.insert(matrices.end(), {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, -7.0f - static_cast<float>(i), 0, 1});
  }
  gltf.json["skins"] = {
      {{"name", "leg"}, {"joints", {1, 2}}, {"inverseBindMatrices", gltf.add_floats(matrices, "MAT4", 16)}}};
  Json& attributes = gltf.json["meshes"][0]["primitives"][0]["attributes"];
  attributes["JOINTS_0"] =
      gltf.add_accessor<uint8_t>({0, 1, 0, 0, 1, 0, 0, 9, 0, 0, 0, 0}, unsigned_byte_type, "VEC4", 3);
  attributes["WEIGHTS_0"] = gltf.add_floats({0.25f, 0.75f, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0}, "VEC4", 4);
  const int times = gltf.add_floats({0.5f, 2}, "SCALAR", 1);
  gltf.json["accessors"][times]["min"] = {0.5};
  gltf.json["accessors"][times]["max"] = {2};
  const int turns = gltf.add_floats({0, 0, 0, 1, 0, 0, 0, 1}, "VEC4", 4);
  gltf.json["animations"] = {{{"samplers", {{{"input", times}, {"output", turns}}}},
                              {"channels", {{{"sampler", 0}, {"target", {{"node", 2}, {"path", "rotation"}}}}}}}};
  return gltf;
}

TEST(Skin, IsKeptWithItsJointsAndItsBindPose) {
  const pack::Contents pack = skinned_triangle().bake();
  ASSERT_EQ(pack.skins.size(), 1u);
  EXPECT_EQ(text_of(pack, pack.skins[0].name), "leg");
  ASSERT_EQ(pack.joints.size(), 2u);
  EXPECT_EQ(pack.joints[1].joint_from_bind[1].w, -8);
  EXPECT_EQ(text_of(pack, pack.nodes.at(pack.joints[1].node).name), "knee");
  ASSERT_EQ(pack.instances.size(), 1u);
  EXPECT_EQ(pack.instances[0].skin, 0u);
  EXPECT_EQ(pack.instances[0].dynamic, 1u);
  EXPECT_EQ(pack.instances[0].world_from_local[0].w, 0);  // where the first joint has it, not at x = 50
  EXPECT_EQ(pack.meshes.at(0).skin_vertex_count, 3u);
}

TEST(Skin, ThatIsAnimatedSaysWhereItsBindPoseIsNotWhatTheFileShows) {
  GltfBuilder gltf = skinned_triangle();
  Warnings none, one;
  gltf.import(&none);
  EXPECT_TRUE(none.lines().empty());
  gltf.json["nodes"][2]["translation"] = {0, 1, 0.5};
  gltf.import(&one);
  ASSERT_EQ(one.lines().size(), 1u);
  EXPECT_NE(one.lines()[0].find("skin 0 'leg': animation of a skin is not played"), std::string::npos);
}

TEST(Skin, ThatStandsFarAwaySaysSoToo) {
  GltfBuilder gltf = skinned_triangle();
  gltf.json["scenes"] = {{{"nodes", {0, 3}}}};
  gltf.json["scene"] = 0;
  gltf.add_node({{"translation", {500000.3, 12.7, -70000.1}}, {"rotation", {0, 0.6, 0, 0.8}}, {"children", {1}}});
  Warnings none, one;
  gltf.import(&none);
  EXPECT_TRUE(none.lines().empty());
  gltf.json["nodes"][2]["translation"] = {0, 1, 0.5};
  gltf.import(&one);
  ASSERT_EQ(one.lines().size(), 1u);
  EXPECT_NE(one.lines()[0].find("skin 0 'leg': animation of a skin is not played"), std::string::npos);
}

TEST(Animation, KeepsAMeshThatGrowsFromNothing) {
  for (const bool above : {false, true}) {  // the mesh's own node, or the one above it
    GltfBuilder gltf = moving_triangle("scale");
    gltf.json["nodes"][1]["scale"] = {0, 0, 0};
    gltf.json["nodes"][2]["scale"] = {0, 0, 0};
    if (!above) gltf.json["nodes"][1] = {{"name", "arm"}, {"mesh", 0}, {"scale", {0, 0, 0}}};
    const int grown = gltf.add_floats({0, 0, 0, 40, 40, 40}, "VEC3", 3);
    gltf.json["animations"][0]["samplers"][0]["output"] = grown;
    gltf.json["nodes"][0].erase(above ? "none" : "mesh");
    Warnings warnings;
    const Scene scene = gltf.import(&warnings);
    ASSERT_EQ(scene.instances.size(), 1u) << above;
    EXPECT_EQ(warnings.lines().size(), 1u);                              // of "still", which stays a point
    const pack::Contents pack = gltf.bake({.position_error_m = 0.01f});  // checks the pack too
    ASSERT_EQ(pack.instances.size(), 1u);
    EXPECT_EQ(pack.instances[0].dynamic, 1u);
    EXPECT_EQ(pack.instances[0].node, above ? 1u : 0u);
    EXPECT_TRUE(pack.batch_bvh.empty());
    EXPECT_TRUE(pack.instance_bvh.empty());
    EXPECT_EQ(pack.indices.size(), 3u);
  }
}

TEST(Animation, MeasuresErrorsAtTheScalesThatItReaches) {
  GltfBuilder gltf = moving_triangle("scale");
  gltf.json["nodes"][0]["scale"] = {0.5, 0.5, 0.5};
  gltf.json["nodes"].erase(2);
  gltf.json["meshes"][0]["primitives"][0]["attributes"]["POSITION"] =
      gltf.add_positions({0.1f, 0.2f, 0.3f, 70, 0.7f, 0, 0, 1.3f, 90.1f});
  gltf.json["animations"][0]["samplers"][0]["output"] = gltf.add_floats({1, 1, 1, 0, -64, 0}, "VEC3", 3);
  const Scene scene = gltf.import();
  const pack::Contents pack = gltf.bake({.position_error_m = 0.01f});
  double farthest = 0;  // at the last key: 64 times the mesh's own 0.5
  for (const Vertex& vertex : scene.meshes.at(0).primitives.at(0).vertices) {
    double nearest = INFINITY;
    for (const pack::Position& p : pack.positions) {
      nearest = std::min(nearest, 32.0 * glm::distance(glm::dvec3(p.position_ls), glm::dvec3(vertex.position_ls)));
    }
    farthest = std::max(farthest, nearest);
  }
  EXPECT_GT(farthest, 0);
  EXPECT_LE(farthest, pack.bake_info.position_error_m);
  EXPECT_LE(pack.bake_info.position_error_m, 0.01f);
}

TEST(Skin, ThatIsIgnoredLeavesItsMeshWhereItsNodeIs) {
  GltfBuilder gltf = skinned_triangle();
  gltf.json["meshes"][0]["primitives"][0]["attributes"].erase("JOINTS_0");
  gltf.json["meshes"][0]["primitives"][0]["attributes"].erase("WEIGHTS_0");
  gltf.json["nodes"][0]["scale"] = {0, 0, 0};
  Warnings warnings;
  EXPECT_TRUE(gltf.import(&warnings).instances.empty());
  ASSERT_EQ(warnings.lines().size(), 2u);
  EXPECT_NE(warnings.lines()[1].find("a mesh whose scale is zero"), std::string::npos);
}

TEST(Skin, LeavesItsBatchesWithoutCones) {
  GltfBuilder gltf = skinned_triangle();
  const pack::Contents bent = gltf.bake();
  ASSERT_EQ(bent.batches.size(), 1u);
  EXPECT_EQ(bent.batches[0].cone_cutoff, 1);
  EXPECT_EQ(bent.batches[0].cone_axis_ls, glm::vec3(0));
  gltf.json["nodes"][0].erase("skin");
  EXPECT_LT(gltf.bake().batches.at(0).cone_cutoff, 1);
}

TEST(Skin, KeepsTrianglesThatAreTogetherOnlyInTheBindPose) {
  GltfBuilder gltf = skinned_triangle();
  Json& primitive = gltf.json["meshes"][0]["primitives"][0];
  primitive.erase("indices");
  const std::vector<float> twins = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 1, 0};
  primitive["attributes"]["POSITION"] = gltf.add_positions(twins);
  std::vector<uint8_t> joints(24, 0);
  for (size_t i = 12; i < 24; i += 4) joints[i] = 1;
  primitive["attributes"]["JOINTS_0"] = gltf.add_accessor<uint8_t>(joints, unsigned_byte_type, "VEC4", 6);
  std::vector<float> weights(24, 0);
  for (size_t i = 0; i < 24; i += 4) weights[i] = 1;
  primitive["attributes"]["WEIGHTS_0"] = gltf.add_floats(weights, "VEC4", 4);
  EXPECT_EQ(gltf.bake().indices.size(), 6u);
}

TEST(Skin, QuantizesItsWeights) {
  const Scene scene = skinned_triangle().import();
  const std::vector<SkinVertex>& vertices = scene.meshes.at(0).primitives.at(0).skin_vertices;
  ASSERT_EQ(vertices.size(), 3u);
  EXPECT_EQ(vertices[0].weights, (std::array<uint16_t, 4>{16384, 49151, 0, 0}));
  EXPECT_EQ(vertices[0].joints, (std::array<uint16_t, 4>{0, 1, 0, 0}));
  EXPECT_EQ(vertices[1].joints, (std::array<uint16_t, 4>{1, 0, 0, 0}));  // 9 has no weight
}

TEST(Skin, WeightsSumToTheWholeAndAreOffByLessThanOne) {
  uint32_t seed = 1;
  for (int round = 0; round < 10000; ++round) {
    std::array<float, 4> weights{};
    double sum = 0;
    for (float& weight : weights) {
      seed = seed * 1664525u + 1013904223u;
      weight = seed % 5 == 0 ? 0 : static_cast<float>(seed >> 8) / 16777216.0f;
      sum += weight;
    }
    const auto whole = quantize_weights(weights);
    EXPECT_EQ(whole[0] + whole[1] + whole[2] + whole[3], 65535);
    for (size_t i = 0; sum > 0 && i < 4; ++i) EXPECT_LT(std::abs(whole[i] - weights[i] / sum * 65535), 1);
  }
  EXPECT_EQ(quantize_weights({0, 0, 0, 0}), (std::array<uint16_t, 4>{65535, 0, 0, 0}));
}

TEST(Skin, IsIgnoredWithAWarningWhereVerticesHaveNoJoints) {
  GltfBuilder gltf = skinned_triangle();
  gltf.json["meshes"][0]["primitives"][0]["attributes"].erase("JOINTS_0");
  gltf.json["meshes"][0]["primitives"][0]["attributes"].erase("WEIGHTS_0");
  Warnings warnings;
  EXPECT_EQ(gltf.import(&warnings).instances.at(0).skin, no_index);
  ASSERT_EQ(warnings.lines().size(), 1u);
  EXPECT_NE(warnings.lines()[0].find("a skin is ignored: its mesh has vertices without joints"), std::string::npos);
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

Json& sampler(GltfBuilder& gltf) {
  return gltf.json["animations"][0]["samplers"][0];
}

Json& channel(GltfBuilder& gltf) {
  return gltf.json["animations"][0]["channels"][0];
}

TEST(Animation, IsRefusedWhereItCannotBePlayed) {
  expect_errors(
      [] { return moving_triangle(); },
      {{"sampler past the end", [](GltfBuilder& g) { channel(g)["sampler"] = 1; },
        "animation 0 'wave', channel 0, sampler: points past the end, there are 1 (1)"},
       {"node past the end", [](GltfBuilder& g) { channel(g)["target"]["node"] = 3; },
        "animation 0 'wave', channel 0, target, node: points past the end, there are 3 (3)"},
       {"unknown interpolation", [](GltfBuilder& g) { sampler(g)["interpolation"] = "BEZIER"; },
        "animation 0 'wave', sampler 0, interpolation: is not LINEAR, STEP or CUBICSPLINE (\"BEZIER\")"},
       {"animated matrix",
        [](GltfBuilder& g) { g.json["nodes"][1]["matrix"] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1}; },
        "animation 0 'wave', channel 0, target, node: is animated but has a matrix (1)"},
       {"twice", [](GltfBuilder& g) { g.json["animations"][0]["channels"].push_back(channel(g)); },
        "animation 0 'wave', channel 1, target, path: is animated twice (\"rotation\")"},
       {"equal times",
        [](GltfBuilder& g) {
          sampler(g)["input"] = g.add_floats({1, 1}, "SCALAR", 1);
        },
        "animation 0 'wave', sampler 0, input: times do not ascend (1 s at key 1)"},
       {"negative time",
        [](GltfBuilder& g) {
          sampler(g)["input"] = g.add_floats({-1, 1}, "SCALAR", 1);
        },
        "animation 0 'wave', sampler 0, input: a key has a negative time (-1 s)"},
       {"infinite time",
        [](GltfBuilder& g) {
          sampler(g)["input"] = g.add_floats({0, INFINITY}, "SCALAR", 1);
        },
        "animation 0 'wave', sampler 0, input: value is not finite (inf in element 1)"},
       {"few values",
        [](GltfBuilder& g) {
          sampler(g)["output"] = g.add_floats({0, 0, 0, 1}, "VEC4", 4);
        },
        "animation 0 'wave', sampler 0, output: has a different number of values than its keys need, 2 (1)"},
       {"three components",
        [](GltfBuilder& g) {
          sampler(g)["output"] = g.add_positions({0, 0, 0, 1, 0, 0});
        },
        "animation 0 'wave', sampler 0, output: accessor 4 has the wrong type (3 components)"},
       {"zero rotation",
        [](GltfBuilder& g) {
          sampler(g)["output"] = g.add_floats({0, 0, 0, 1, 0, 0, 0, 0}, "VEC4", 4);
        },
        "animation 0 'wave', sampler 0, output: rotation has no direction (key 1)"}});
}

TEST(Skin, IsRefusedWhereItCannotPose) {
  expect_errors(skinned_triangle,
                {{"no joints", [](GltfBuilder& g) { g.json["skins"][0]["joints"] = Json::array(); },
                  "skin 0 'leg', joints: are not 1 to 65535 (0)"},
                 {"joint twice",
                  [](GltfBuilder& g) {
                    g.json["skins"][0]["joints"] = {1, 1};
                  },
                  "skin 0 'leg', joints: names a node twice (1)"},
                 {"joint past the end",
                  [](GltfBuilder& g) {
                    g.json["skins"][0]["joints"] = {1, 8};
                  },
                  "skin 0 'leg', joints: points past the end, there are 3 (8)"},
                 {"few matrices", [](GltfBuilder& g) { g.json["accessors"][2]["count"] = 1; },
                  "skin 0 'leg', inverseBindMatrices: has fewer matrices than there are joints, 2 (1)"},
                 {"matrix that is not affine",
                  [](GltfBuilder& g) {
                    std::vector<float> ones(32, 1);
                    g.json["skins"][0]["inverseBindMatrices"] = g.add_floats(ones, "MAT4", 16);
                  },
                  "skin 0 'leg', inverseBindMatrices: the last row of a matrix is not 0, 0, 0, 1 (1 in matrix 0)"},
                 {"joint that the skin lacks", [](GltfBuilder& g) { g.json["skins"][0]["joints"] = {1}; },
                  "node 0 'triangle': its mesh uses joints that its skin lacks; the skin's number of joints is 1 (1)"},
                 {"negative weight",
                  [](GltfBuilder& g) {
                    g.json["meshes"][0]["primitives"][0]["attributes"]["WEIGHTS_0"] =
                        g.add_floats({1, 0, 0, 0, 2, -1, 0, 0, 1, 0, 0, 0}, "VEC4", 4);
                  },
                  "mesh 0, primitive 0, attribute WEIGHTS_0: a weight is negative (vertex 1)"},
                 {"float joints",
                  [](GltfBuilder& g) {
                    Json& attributes = g.json["meshes"][0]["primitives"][0]["attributes"];
                    attributes["JOINTS_0"] = attributes["WEIGHTS_0"];
                  },
                  "mesh 0, primitive 0, attribute JOINTS_0: component type is not unsigned byte or short (5126)"}});
}

}  // namespace
}  // namespace chandelier::baker::test
