// SPDX-License-Identifier: Apache-2.0
// Rules between the fields of what moves: each breach is named.
#include <gtest/gtest.h>

#include <functional>

#include "pack_checks_animation.h"
#include "pack_sample.h"

namespace chandelier::pack::test {
namespace {

/// The sample with two nodes, an animation of two channels, and a skin that poses its mesh.
Contents moving_sample() {
  Contents c = sample();
  for (Mesh& mesh : c.meshes) mesh.first_skin_vertex = mesh.skin_vertex_count = 0;
  for (Instance& instance : c.instances) {
    instance.node = instance.skin = none;
    instance.dynamic = 0;
  }
  Node root;
  root.rotation = {0, 0, 0, 1};
  root.scale = {1, 1, 1};
  root.parent = none;
  Node child = root;
  child.parent = 0;
  c.nodes = {root, child};
  c.animation_times = {{0}, {0.5f}, {2}};
  c.animation_values.assign(3 * 4 + 2 * 9, {0.25f});
  c.animation_channels = {
      {.node = 0, .path = AnimationPath::rotation, .first_key = 0, .key_count = 3, .first_value = 0, .value_count = 12},
      {.node = 1,
       .path = AnimationPath::scale,
       .interpolation = Interpolation::cubic_spline,
       .first_key = 1,
       .key_count = 2,
       .first_value = 12,
       .value_count = 18}};
  c.animations = {{.first_channel = 0, .channel_count = 2, .duration_s = 2}};
  c.joints.resize(2);
  c.joints[1].node = 1;
  c.skins = {{.first_joint = 0, .joint_count = 2}};
  c.skin_vertices.resize(4);
  for (SkinVertex& vertex : c.skin_vertices) {
    vertex.joints[0] = 1;  // joints 1 and 0
    vertex.weights[0] = 60000 | 5535u << 16;
  }
  c.meshes[0].skin_vertex_count = 4;
  c.instances[0].skin = 0;
  c.instances[0].dynamic = 1;
  c.batch_bvh.clear();  // it holds what stands still
  c.batch_bvh_items.clear();
  c.instance_bvh.clear();
  c.instance_bvh_items.clear();
  return c;
}

struct Breach {
  const char* name;
  std::function<void(Contents&)> commit;
  const char* error;
};

void PrintTo(const Breach& breach, std::ostream* out) {
  *out << breach.name;
}

const Breach breaches[] = {
    {"ParentAfterChild", [](Contents& c) { c.nodes[0].parent = 1; },
     "nodes[0].parent: 1 does not come before its child"},
    {"OwnParent", [](Contents& c) { c.nodes[1].parent = 1; }, "nodes[1].parent: 1 does not come before its child"},
    {"Rotation",
     [](Contents& c) {
       c.nodes[1].rotation = {0, 0, 0, 2};
     },
     "nodes[1].rotation: its length is not 1"},
    {"ValueCount", [](Contents& c) { c.animation_channels[0].value_count = 9; },
     "animation_channels[0].value_count: 9 where its keys have 12"},
    {"CubicValueCount", [](Contents& c) { c.animation_channels[1].value_count = 6; },
     "animation_channels[1].value_count: 6 where its keys have 18"},
    {"EqualTimes", [](Contents& c) { c.animation_times[1].time_s = 2; },
     "animation_times[2].time_s: does not ascend in animation_channels[0]"},
    {"Duration", [](Contents& c) { c.animations[0].duration_s = 1; },
     "animations[0].duration_s: ends before animation_channels[0] does"},
    {"Weights", [](Contents& c) { c.skin_vertices[3].weights[1] = 1; },
     "skin_vertices[3].weights: sum to 65536, not 65535"},
    {"SkinVertexCount", [](Contents& c) { c.meshes[0].skin_vertex_count = 3; },
     "meshes[0].skin_vertex_count: 3 is neither 0 nor its 4 vertices"},
    {"WildJoint", [](Contents& c) { c.skin_vertices[2].joints[1] = 2u << 16; },
     "instances[0].skin: has 2 joints where meshes[0] asks for 3"},
    {"SkinWithoutVertices", [](Contents& c) { c.meshes[0].skin_vertex_count = 0; },
     "instances[0].skin: has 2 joints where meshes[0] asks for 0"},
    {"SkinnedButStatic", [](Contents& c) { c.instances[0].dynamic = 0; },
     "instances[0].dynamic: 0 where a node or a skin moves it"},
    {"MovedButStatic", [](Contents& c) { c.instances[1].node = 1; },
     "instances[1].dynamic: 0 where a node or a skin moves it"},
};

class PackAnimationRules : public testing::TestWithParam<Breach> {};

TEST_P(PackAnimationRules, BreachIsNamed) {
  Contents contents = moving_sample();
  GetParam().commit(contents);
  EXPECT_EQ(animation_fault(view_of(contents)), GetParam().error);
}

INSTANTIATE_TEST_SUITE_P(Each, PackAnimationRules, testing::ValuesIn(breaches),
                         [](const auto& each) { return each.param.name; });

TEST(PackAnimation, IsRightAsItIs) {
  EXPECT_EQ(animation_fault(view_of(moving_sample())), "");
}

}  // namespace
}  // namespace chandelier::pack::test
