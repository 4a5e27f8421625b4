// SPDX-License-Identifier: Apache-2.0
// Rules between the fields of what moves: each breach is named.
#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <string>

#include "pack_breach.h"
#include "pack_checks_animation.h"

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
    {"SharedChannels", [](Contents& c) { c.animations.push_back(c.animations[0]); },
     "animations[1].first_channel: 0 where those before it end at 2"},
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

INSTANTIATE_TEST_SUITE_P(Each, PackAnimationRules, testing::ValuesIn(breaches), name_of_breach);

TEST(PackAnimation, IsRightAsItIs) {
  EXPECT_EQ(animation_fault(view_of(moving_sample())), "");
}

/// Between them 10^12 keys, which would take many minutes to look at one by one.
TEST(PackAnimation, ManyChannelsMayShareManyKeys) {
  constexpr uint32_t count = 1000000;
  Contents c = moving_sample();
  c.animations = {{.first_channel = 0, .channel_count = count, .duration_s = static_cast<float>(2 * count)}};
  c.animation_times.clear();
  for (uint32_t k = 0; k < count; ++k) c.animation_times.push_back({static_cast<float>(k)});
  c.animation_values.assign(4 * size_t{count}, {0.25f});
  AnimationChannel channel = c.animation_channels[0];
  channel.key_count = count;
  channel.value_count = 4 * count;
  c.animation_channels.assign(count, channel);
  EXPECT_EQ(animation_fault(view_of(c)), "");
  for (AnimationChannel& each : c.animation_channels)
    each = {.path = channel.path, .key_count = count - 1, .value_count = 4 * count - 4};
  c.animation_channels.back() = channel;
  c.animation_times.back().time_s = c.animation_times[count - 2].time_s;
  EXPECT_EQ(animation_fault(view_of(c)),
            "animation_times[999999].time_s: does not ascend in animation_channels[999999]");
}

TEST(PackAnimation, ManyMeshesMayShareManySkinVertices) {
  constexpr uint32_t count = 1000000;
  Contents c = moving_sample();
  c.skin_vertices.resize(count, c.skin_vertices[0]);
  Mesh mesh = c.meshes[0];
  mesh.first_skin_vertex = 0;
  mesh.vertex_count = mesh.skin_vertex_count = count;
  c.meshes.assign(count, mesh);
  EXPECT_EQ(animation_fault(view_of(c)), "");
}

TEST(PackAnimation, AChannelMayBeginWhereAnotherEnded) {
  Contents c = moving_sample();
  c.animation_times = {{0}, {2}, {1}, {2}, {2}};
  c.animation_channels[0].first_key = 2;
  c.animation_channels[0].key_count = 2;
  c.animation_channels[0].value_count = 8;
  c.animation_channels[1].first_key = 0;
  EXPECT_EQ(animation_fault(view_of(c)), "");
}

/// Meshes with any runs of skin vertices, against a look at each vertex of each: a skin with one joint less than a mesh
/// asks for is refused, and one with as many is not.
TEST(PackAnimation, MeshesAskForTheJointsOfTheirOwnVertices) {
  std::mt19937 random(7);
  const auto below = [&](uint32_t end) { return static_cast<uint32_t>(random() % end); };
  for (int round = 0; round < 200; ++round) {
    Contents c = moving_sample();
    c.skin_vertices.resize(1 + below(40), c.skin_vertices[0]);
    for (SkinVertex& vertex : c.skin_vertices) vertex.joints = {below(9) | below(9) << 16, below(9) | below(9) << 16};
    const auto vertices = static_cast<uint32_t>(c.skin_vertices.size());
    Instance instance = c.instances[0];
    c.meshes.resize(1 + below(20), c.meshes[0]);
    c.instances.clear();
    c.skins.clear();
    for (uint32_t i = 0; i < c.meshes.size(); ++i) {
      const uint32_t first = below(vertices), size = 1 + below(vertices - first);
      c.meshes[i].first_skin_vertex = first;
      c.meshes[i].vertex_count = c.meshes[i].skin_vertex_count = size;
      uint32_t asked = 0;
      for (uint32_t v = first; v < first + size; ++v) {
        for (const uint32_t pair : c.skin_vertices[v].joints) {
          asked = std::max({asked, (pair & 0xFFFF) + 1, (pair >> 16) + 1});
        }
      }
      instance.mesh = instance.skin = i;
      c.instances.push_back(instance);
      c.skins.push_back({.first_joint = 0, .joint_count = asked});
    }
    EXPECT_EQ(animation_fault(view_of(c)), "");
    const uint32_t less = below(static_cast<uint32_t>(c.skins.size()));
    const uint32_t asked = c.skins[less].joint_count--;
    const std::string i = std::to_string(less);
    EXPECT_EQ(animation_fault(view_of(c)), "instances[" + i + "].skin: has " + std::to_string(asked - 1) +
                                               " joints where meshes[" + i + "] asks for " + std::to_string(asked));
  }
}

}  // namespace
}  // namespace chandelier::pack::test
