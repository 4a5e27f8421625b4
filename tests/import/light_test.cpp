// SPDX-License-Identifier: Apache-2.0
// Lights: types, places, directions, names, ranges.
#include <gtest/gtest.h>

#include <cmath>

#include "bake/lights.h"
#include "gltf_builder.h"

namespace chandelier::baker::test {
namespace {

GltfBuilder with_light(const Json& light, const Json& node_fields = Json::object()) {
  GltfBuilder gltf;
  gltf.json["extensionsUsed"] = {"KHR_lights_punctual"};
  gltf.json["extensionsRequired"] = {"KHR_lights_punctual"};
  gltf.json["extensions"]["KHR_lights_punctual"]["lights"] = {light};
  Json node = node_fields;
  node["extensions"]["KHR_lights_punctual"]["light"] = 0;
  gltf.add_node(node);
  return gltf;
}

void expect_near(const glm::vec3& a, const glm::vec3& b) {
  EXPECT_LT(glm::length(a - b), 1e-6f);
}

TEST(Light, StandsWhereItsNodeStandsWithAnAuthoredRange) {
  const pack::Contents pack = with_light({{"type", "point"}, {"name", "bulb"}, {"range", 7}, {"intensity", 30}},
                                         {{"translation", {1, 2, 3}}, {"scale", {5, 5, 5}}})
                                  .bake();
  ASSERT_EQ(pack.lights.size(), 1u);
  const pack::Light& light = pack.lights[0];
  EXPECT_EQ(light.type, pack::LightType::point);
  EXPECT_EQ(light.position_ws, glm::vec3(1, 2, 3));
  EXPECT_EQ(light.range_m, 7);  // scale does not reach it
  EXPECT_EQ(light.range_source, pack::RangeSource::authored);
  EXPECT_EQ(light.intensity, 30);
  EXPECT_EQ(light.color, glm::vec3(1));
  EXPECT_EQ(light.inner_cone_cos, 1);
  EXPECT_EQ(light.outer_cone_cos, -1);
  EXPECT_EQ(text_of(pack, light.name), "bulb");
}

TEST(Light, IsNamedAfterItsNodeFirst) {
  const pack::Contents pack = with_light({{"type", "point"}, {"name", "bulb"}}, {{"name", "desk"}}).bake();
  EXPECT_EQ(text_of(pack, pack.lights.at(0).name), "desk");
}

TEST(Light, EndsWhereItsIlluminanceIsTheThresholdIfNothingElseIsSaid) {
  const GltfBuilder gltf = with_light({{"type", "point"}, {"intensity", 40}, {"color", {0.25, 0.5, 0.1}}});
  // 40 cd times the brightest channel, 0.5, is 20 cd: 0.05 lx at sqrt(20 / 0.05) = 20 m, 0.2 lx at 10 m.
  const pack::Contents usual = gltf.bake();
  EXPECT_FLOAT_EQ(usual.lights.at(0).range_m, 20);
  EXPECT_EQ(usual.lights.at(0).range_source, pack::RangeSource::derived);
  EXPECT_FLOAT_EQ(usual.bake_info.range_threshold_lx, 0.05f);
  EXPECT_FLOAT_EQ(gltf.bake({.range_threshold_lx = 0.2f}).lights.at(0).range_m, 10);
}

TEST(Light, ShinesAlongItsNodesNegativeZ) {
  const double half = std::sqrt(0.5);
  const Json spot = {{"type", "spot"}, {"spot", {{"innerConeAngle", 0.1}, {"outerConeAngle", 0.6}}}};
  // A quarter turn about x takes -z to +y: the spot lights the ceiling.
  const pack::Contents pack = with_light(spot, {{"rotation", {half, 0, 0, half}}, {"scale", {3, 1, 2}}}).bake();
  const pack::Light& light = pack.lights.at(0);
  EXPECT_EQ(light.type, pack::LightType::spot);
  expect_near(light.direction_ws, {0, 1, 0});
  EXPECT_FLOAT_EQ(light.inner_cone_cos, std::cos(0.1f));
  EXPECT_FLOAT_EQ(light.outer_cone_cos, std::cos(0.6f));
}

TEST(Light, HasGltfsConeWhereNoAnglesAreGiven) {
  const pack::Contents pack = with_light({{"type", "spot"}, {"spot", Json::object()}}).bake();
  EXPECT_FLOAT_EQ(pack.lights.at(0).inner_cone_cos, 1);
  EXPECT_NEAR(pack.lights.at(0).outer_cone_cos, std::sqrt(0.5), 1e-6);  // 45 degrees
}

TEST(Light, HasNeitherPlaceNorEndWhenDirectional) {
  const pack::Contents pack =
      with_light({{"type", "directional"}, {"intensity", 1000}, {"range", 5}}, {{"translation", {1, 2, 3}}}).bake();
  const pack::Light& light = pack.lights.at(0);
  EXPECT_EQ(light.type, pack::LightType::directional);
  EXPECT_EQ(light.position_ws, glm::vec3(0));
  EXPECT_EQ(light.range_m, 0);
  EXPECT_EQ(light.range_source, pack::RangeSource::unbounded);
  EXPECT_EQ(light.direction_ws, glm::vec3(0, 0, -1));
}

TEST(Light, IsSkippedWithAWarningWhereItGivesNoLight) {
  for (const Json& dark : {Json{{"type", "point"}, {"intensity", 0}}, Json{{"type", "point"}, {"color", {0, 0, 0}}}}) {
    Warnings warnings;
    EXPECT_TRUE(with_light(dark).import(&warnings).lights.empty());
    EXPECT_EQ(warnings.lines().size(), 1u);
  }
}

TEST(Light, IsOfUsualPriorityAndStaticAndClusteredUnlessItsAuthorSaysOtherwise) {
  const pack::Light light = with_light({{"type", "point"}}).bake().lights.at(0);
  EXPECT_EQ(light.priority, 128u);
  EXPECT_EQ(light.dynamic, 0u);
  EXPECT_EQ(light.unclustered, 0u);
  EXPECT_EQ(light.group, 0u);
  EXPECT_EQ(light.node, pack::none);
}

TEST(Light, TakesItsAuthorsWordsFromExtrasTheNodesFirst) {
  const Json on_light = {{"priority", 7}, {"dynamic", true}, {"range_m", 3}, {"power_w", 60}};
  const Json on_node = {{"priority", 9}, {"cluster", false}};
  const GltfBuilder gltf = with_light({{"type", "point"}, {"range", 20}, {"extras", {{"chandelier", on_light}}}},
                                      {{"extras", {{"chandelier", on_node}, {"note", "the big one"}}}});
  const Scene scene = gltf.import();
  EXPECT_EQ(scene.lights.at(0).power_w, 60);
  EXPECT_NE(scene.lights.at(0).where.find("scene.gltf: node 0"), std::string::npos);
  const pack::Light light = gltf.bake().lights.at(0);
  EXPECT_EQ(light.priority, 9u);
  EXPECT_EQ(light.dynamic, 1u);
  EXPECT_EQ(light.unclustered, 1u);
  EXPECT_EQ(light.range_m, 3);
  EXPECT_EQ(light.range_source, pack::RangeSource::authored);
}

TEST(Light, HasShadowAndRadiusFromItsExtras) {
  const auto baked = [](const Json& extras) {
    return with_light({{"type", "point"}, {"extras", {{"chandelier", extras}}}}).bake().lights.at(0);
  };
  const pack::Light plain = baked(Json::object()), authored = baked({{"shadow", false}, {"radius_m", 0.25}});
  EXPECT_EQ(plain.shadowless, 0u);
  EXPECT_EQ(plain.radius_m, 0);
  EXPECT_EQ(authored.shadowless, 1u);
  EXPECT_EQ(authored.radius_m, 0.25f);
  EXPECT_EQ(baked({{"shadow", true}}).shadowless, 0u);
}

TEST(Light, OfGroupsOfTheSameNameHasTheirNumber) {
  Scene scene;
  for (const char* group : {"", "hall", "stage", "", "hall", "hall"}) scene.lights.push_back({.group = group});
  pack::Contents pack;
  Strings strings(pack.strings);
  make_lights(scene, 0.05f, strings, pack);
  std::vector<uint32_t> groups;
  for (const pack::Light& light : pack.lights) groups.push_back(light.group);
  EXPECT_EQ(groups, (std::vector<uint32_t>{0, 1, 2, 0, 1, 1}));
}

TEST(Light, LeavesItsGroupWhereItsNodeSaysSo) {
  const auto group_of = [](const char* on_node) {
    return with_light({{"type", "point"}, {"extras", {{"chandelier", {{"group", "hall"}}}}}},
                      {{"extras", {{"chandelier", {{"group", on_node}}}}}})
        .import()
        .lights.at(0)
        .group;
  };
  EXPECT_EQ(group_of("stage"), "stage");
  EXPECT_EQ(group_of(""), "");
}

TEST(Light, HasBoundsAroundWhatItReaches) {
  const pack::Light point =
      with_light({{"type", "point"}, {"range", 7}}, {{"translation", {1, 2, 3}}}).bake().lights.at(0);
  EXPECT_EQ(point.bounds_center_ws, glm::vec3(1, 2, 3));
  EXPECT_EQ(point.bounds_radius_m, 7);
  const Json spot = {{"type", "spot"}, {"range", 6}, {"spot", {{"outerConeAngle", 1.0471975512}}}};  // 60 degrees
  const pack::Light lit = with_light(spot).bake().lights.at(0);
  expect_near(lit.bounds_center_ws, {0, 0, -3});  // in the middle of the rim
  EXPECT_NEAR(lit.bounds_radius_m, 6 * std::sqrt(0.75), 1e-5);
}

TEST(Light, IsInAVoxelWhereThereAreAny) {
  GltfBuilder gltf = one_triangle();
  gltf.json["extensionsUsed"] = {"KHR_lights_punctual"};
  gltf.json["extensions"]["KHR_lights_punctual"]["lights"] = {{{"type", "point"}}, {{"type", "directional"}}};
  const Json inside = {0.25, 0.25, 0}, outside = {2, 0.25, 0};
  for (const auto& [light, place] : {std::pair(0, inside), std::pair(0, outside), std::pair(1, inside)}) {
    gltf.add_node({{"translation", place}, {"extensions", {{"KHR_lights_punctual", {{"light", light}}}}}});
  }
  const pack::Contents pack = gltf.bake();
  ASSERT_EQ(pack.voxel_grid.size(), 1u);
  const pack::VoxelGrid& grid = pack.voxel_grid[0];
  const auto cell = glm::uvec3((glm::vec3(0.25f, 0.25f, 0) - grid.bounds_min_ws) / grid.cell_size_m);
  EXPECT_EQ(pack.lights.at(0).voxel, cell.x + grid.resolution[0] * (cell.y + grid.resolution[1] * cell.z));
  EXPECT_EQ(pack.lights.at(1).voxel, pack::none);
  EXPECT_EQ(pack.lights.at(2).voxel, pack::none);
}

TEST(Light, ServesManyNodes) {
  GltfBuilder gltf = with_light({{"type", "point"}});
  gltf.add_node({{"translation", {4, 0, 0}}, {"extensions", {{"KHR_lights_punctual", {{"light", 0}}}}}});
  const pack::Contents pack = gltf.bake();
  ASSERT_EQ(pack.lights.size(), 2u);
  EXPECT_EQ(pack.lights[1].position_ws, glm::vec3(4, 0, 0));
}

}  // namespace
}  // namespace chandelier::baker::test
