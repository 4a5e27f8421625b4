// SPDX-License-Identifier: Apache-2.0
// Lights and light hierarchies that break a rule: opening names the record. No file may send a traversal in circles.
#include <gtest/gtest.h>

#include "pack_breach.h"

namespace chandelier::pack::test {
namespace {

// The sample: lights 0 (point), 1 (spot), 2 (directional); nodes 0 (inner), 1 (light 0), 2 (light 1).
const Breach breaches[] = {
    {"OutsideItsBounds", [](Contents& c) { c.lights[0].bounds_center_ws.x += 7.5f; },
     "lights[0].bounds_center_ws: the light is not in its bounds"},
    {"SpotOutsideItsBounds", [](Contents& c) { c.lights[1].bounds_radius_m *= 0.5f; },
     "lights[1].bounds_center_ws: the light is not in its bounds"},
    {"NegativeRadius", [](Contents& c) { c.lights[0].bounds_radius_m = -1; },
     "lights[0].bounds_radius_m: -1 is below 0"},
    {"Priority", [](Contents& c) { c.lights[0].priority = 256; }, "lights[0].priority: 256 is above 255"},
    {"GroupLeftOut", [](Contents& c) { c.lights[2].group = 3; }, "lights[2].group: 3 comes after 1 groups"},
    {"GroupsFromTwo", [](Contents& c) { c.lights[0].group = 2; }, "lights[0].group: 2 comes after 0 groups"},
    {"VoxelOfTheSun", [](Contents& c) { c.lights[2].voxel = 0; }, "lights[2].voxel: a directional light has none"},
    {"VoxelBeyondTheGrid", [](Contents& c) { c.lights[0].voxel = 2; },
     "lights[0].voxel: 2 is not below the 2 voxel_cells"},
    {"MissItself", [](Contents& c) { c.light_bvh[0].miss = 0; }, "light_bvh[0].miss: 0 is not from 2 to 3"},
    {"MissBack", [](Contents& c) { c.light_bvh[2].miss = 1; }, "light_bvh[2].miss: 1 is not from 3 to 3"},
    {"MissBeyondTheNodes", [](Contents& c) { c.light_bvh[0].miss = 4; }, "light_bvh[0].miss: 4 is not from 2 to 3"},
    {"LeafSkipsItsSibling", [](Contents& c) { c.light_bvh[1].miss = 3; }, "light_bvh[1].miss: 3 is not from 2 to 2"},
    {"InnerNodeWithoutChildren",
     [](Contents& c) {
       c.light_bvh[1] = {{}, 1, 2, none};
     },
     "light_bvh[1].miss: 2 is not from 3 to 3"},
    {"SunInALeaf", [](Contents& c) { c.light_bvh[2].light = 2; }, "light_bvh[2].light: 2 is a directional light"},
    {"OneLightTwice", [](Contents& c) { c.light_bvh[2].light = 0; }, "light_bvh[2].light: 0 has a leaf already"},
    {"WildLight", [](Contents& c) { c.light_bvh[2].light = 3; }, "light_bvh[2].light: 3 is not below the 3 lights"},
    {"LightLeftOut",
     [](Contents& c) {
       c.light_bvh = {{{1, 2, 3}, 7, 1, 0}};
     },
     "light_bvh: 1 leaves for 2 point and spot lights"},
};

class PackLightRules : public testing::TestWithParam<Breach> {};

TEST_P(PackLightRules, BreachIsNamed) {
  expect_named(GetParam());
}

INSTANTIATE_TEST_SUITE_P(Each, PackLightRules, testing::ValuesIn(breaches), name_of_breach);

// A subtree that reaches past the one that it is in would skip nodes of another: ((0 1) 2) with a wrong inner node.
TEST(PackLightRulesNesting, ASubtreeEndsWithinItsParents) {
  Contents contents = sample();
  contents.lights.push_back(contents.lights[0]);
  contents.light_bvh = {{{1, 2, 3}, 99, 5, none},
                        {{1, 2, 3}, 99, 4, none},
                        {{1, 2, 3}, 7, 3, 0},
                        {{1, 2, 3}, 99, 4, 1},
                        {{1, 2, 3}, 7, 5, 3}};
  EXPECT_EQ(check(view_of(contents)), "");
  contents.light_bvh[1].miss = 3;
  EXPECT_EQ(check(view_of(contents)), "");  // an inner node with one child: odd, and harmless
  contents.light_bvh[1].miss = 6;
  EXPECT_EQ(check(view_of(contents)), "light_bvh[1].miss: 6 is not from 3 to 5");
}

TEST(PackLightRulesNesting, APackMayHaveLightsAndNoHierarchy) {
  Contents contents = sample();
  contents.light_bvh.clear();
  EXPECT_EQ(check(view_of(contents)), "");
}

}  // namespace
}  // namespace chandelier::pack::test
