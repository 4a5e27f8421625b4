// SPDX-License-Identifier: Apache-2.0
// Writes nodes, animations and skins into their records, in the scene's order.
#include "animation.h"

#include <algorithm>
#include <array>

#include "../error.h"

namespace chandelier::baker {
namespace {

static_assert(static_cast<int>(AnimationPath::scale) == static_cast<int>(pack::AnimationPath::scale));
static_assert(static_cast<int>(Interpolation::cubic_spline) == static_cast<int>(pack::Interpolation::cubic_spline));

template <typename Matrix>
std::array<glm::vec4, 3> rows_of(const Matrix& matrix) {
  std::array<glm::vec4, 3> out;
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 4; ++column) out[row][column] = static_cast<float>(matrix[column][row]);
  }
  return out;
}

void add_node(const Node& node, Strings& strings, pack::Contents& pack) {
  pack::Node out;
  std::ranges::copy(rows_of(node.parent_from_local), std::begin(out.parent_from_local));
  out.translation = glm::vec3(node.translation);
  out.rotation = node.rotation;
  out.scale = node.scale;
  out.parent = node.parent;
  out.name = strings.add(node.name);
  pack.nodes.push_back(out);
}

/// The first time of the channel; appends its times unless the channel before has the same ones.
uint32_t add_times(const AnimationChannel& channel, const AnimationChannel* before, pack::Contents& pack) {
  if (before && before->times_s == channel.times_s) return pack.animation_channels.back().first_key;
  const uint32_t first = fit_u32(pack.animation_times.size(), "animation keys");
  for (const float time : channel.times_s) pack.animation_times.push_back({time});
  fit_u32(pack.animation_times.size(), "animation keys");
  return first;
}

void add_animation(const Animation& animation, Strings& strings, pack::Contents& pack) {
  pack::Animation out;
  out.first_channel = fit_u32(pack.animation_channels.size(), "animation channels");
  out.channel_count = fit_u32(animation.channels.size(), "animation channels");
  out.name = strings.add(animation.name);
  const AnimationChannel* before = nullptr;
  for (const AnimationChannel& channel : animation.channels) {
    pack::AnimationChannel record;
    record.node = channel.node;
    record.path = static_cast<pack::AnimationPath>(channel.path);
    record.interpolation = static_cast<pack::Interpolation>(channel.interpolation);
    record.first_key = add_times(channel, before, pack);
    record.key_count = fit_u32(channel.times_s.size(), "animation keys");
    record.first_value = fit_u32(pack.animation_values.size(), "animation values");
    record.value_count = fit_u32(channel.values.size(), "animation values");
    for (const float value : channel.values) pack.animation_values.push_back({value});
    fit_u32(pack.animation_values.size(), "animation values");
    out.duration_s = std::max(out.duration_s, channel.times_s.back());
    pack.animation_channels.push_back(record);
    before = &channel;
  }
  pack.animations.push_back(out);
}

void add_skin(const Skin& skin, Strings& strings, pack::Contents& pack) {
  pack::Skin out;
  out.first_joint = fit_u32(pack.joints.size(), "joints");
  out.joint_count = fit_u32(skin.joints.size(), "joints");
  out.name = strings.add(skin.name);
  for (const Joint& joint : skin.joints) {
    pack::Joint record;
    std::ranges::copy(rows_of(joint.joint_from_bind), std::begin(record.joint_from_bind));
    record.node = joint.node;
    pack.joints.push_back(record);
  }
  pack.skins.push_back(out);
}

}  // namespace

void make_animations(const Scene& scene, Strings& strings, pack::Contents& pack) {
  for (const Node& node : scene.nodes) add_node(node, strings, pack);
  for (const Animation& animation : scene.animations) add_animation(animation, strings, pack);
  for (const Skin& skin : scene.skins) add_skin(skin, strings, pack);
}

}  // namespace chandelier::baker
