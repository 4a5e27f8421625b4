// SPDX-License-Identifier: Apache-2.0
// Nodes, animations and skins: the rules that let a player evaluate them without endless loops or wild reads.
#include "pack_checks_animation.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <span>
#include <vector>

#include "pack_checks_text.h"

namespace chandelier::pack {
namespace {

constexpr float unit_tolerance = 1e-3f;

std::string node_fault(const View& view) {
  for (size_t i = 0; i < view.nodes.size(); ++i) {
    const Node& node = view.nodes[i];
    if (node.parent != none && node.parent >= i) {
      return at("nodes", i) + ".parent: " + std::to_string(node.parent) + " does not come before its child";
    }
    const auto& q = node.rotation;
    const float length = std::sqrt(q.x * q.x + q.y * q.y + q.z * q.z + q.w * q.w);
    if (!(std::abs(length - 1) <= unit_tolerance)) {
      return at("nodes", i) + ".rotation: its length is not 1";
    }
  }
  return {};
}

/// The keys whose time is not above that of the key before, in order. Channels may share keys, so each key is looked at
/// once for all of them.
std::vector<size_t> keys_that_do_not_ascend(std::span<const KeyTime> times) {
  std::vector<size_t> keys;
  for (size_t k = 1; k < times.size(); ++k) {
    if (!(times[k].time_s > times[k - 1].time_s)) keys.push_back(k);
  }
  return keys;
}

std::string channel_fault(const View& view) {
  const std::vector<size_t> breaks = keys_that_do_not_ascend(view.animation_times);
  for (size_t i = 0; i < view.animation_channels.size(); ++i) {
    const AnimationChannel& channel = view.animation_channels[i];
    const uint64_t components = channel.path == AnimationPath::rotation ? 4 : 3;
    const uint64_t values = channel.interpolation == Interpolation::cubic_spline ? 3 : 1;
    const uint64_t expected = channel.key_count * components * values;
    if (channel.value_count != expected) {
      return at("animation_channels", i) + ".value_count: " + std::to_string(channel.value_count) +
             " where its keys have " + std::to_string(expected);
    }
    // A break at the channel's first key is between two channels.
    const auto found = std::upper_bound(breaks.begin(), breaks.end(), size_t{channel.first_key});
    if (found != breaks.end() && *found < size_t{channel.first_key} + channel.key_count) {
      return at("animation_times", *found) + ".time_s: does not ascend in " + at("animation_channels", i);
    }
  }
  return {};
}

/// Animations share no channels, so that each channel is looked at once.
std::string duration_fault(const View& view) {
  size_t next_channel = 0;
  for (size_t i = 0; i < view.animations.size(); ++i) {
    const Animation& animation = view.animations[i];
    if (animation.first_channel != next_channel) {
      return at("animations", i) + ".first_channel: " + std::to_string(animation.first_channel) +
             " where those before it end at " + std::to_string(next_channel);
    }
    next_channel += animation.channel_count;
    for (size_t c = 0; c < animation.channel_count; ++c) {
      const AnimationChannel& channel = view.animation_channels[animation.first_channel + c];
      const float last = view.animation_times[channel.first_key + channel.key_count - 1].time_s;
      if (last > animation.duration_s) {
        return at("animations", i) + ".duration_s: ends before " +
               at("animation_channels", animation.first_channel + c) + " does";
      }
    }
  }
  return {};
}

/// One more than the largest number of a joint that a vertex refers to.
uint32_t joints_asked(const SkinVertex& vertex) {
  uint32_t end = 0;
  for (const uint32_t pair : vertex.joints) end = std::max(end, 1 + std::max(pair & 0xFFFFu, pair >> 16));
  return end;
}

/// The same for each mesh. Meshes may share skin vertices, so each vertex is read once for all of them: meshes are
/// sorted by their end, and only vertices whose maximum exceeds all later ones are kept.
std::vector<uint32_t> joints_asked_by_meshes(const View& view) {
  const auto end_of = [](const Mesh& mesh) { return size_t{mesh.first_skin_vertex} + mesh.skin_vertex_count; };
  std::vector<uint32_t> order(view.meshes.size());
  std::iota(order.begin(), order.end(), 0u);
  std::ranges::sort(order, {}, [&](uint32_t i) { return end_of(view.meshes[i]); });
  struct Waiting {
    size_t vertex;
    uint32_t asked;
  };
  std::vector<Waiting> waiting;  // vertices ascend, their maxima descend
  std::vector<uint32_t> asked(view.meshes.size());
  size_t next = 0;
  for (const uint32_t i : order) {
    const Mesh& mesh = view.meshes[i];
    if (mesh.skin_vertex_count == 0) continue;
    for (; next < end_of(mesh); ++next) {
      const uint32_t most = joints_asked(view.skin_vertices[next]);
      while (!waiting.empty() && waiting.back().asked <= most) waiting.pop_back();
      waiting.push_back({next, most});
    }
    asked[i] = std::ranges::lower_bound(waiting, size_t{mesh.first_skin_vertex}, {}, &Waiting::vertex)->asked;
  }
  return asked;
}

std::string skin_vertex_fault(const View& view) {
  for (size_t i = 0; i < view.skin_vertices.size(); ++i) {
    uint32_t sum = 0;
    for (const uint32_t pair : view.skin_vertices[i].weights) sum += (pair & 0xFFFFu) + (pair >> 16);
    if (sum != 65535) return at("skin_vertices", i) + ".weights: sum to " + std::to_string(sum) + ", not 65535";
  }
  return {};
}

std::string skin_fault(const View& view) {
  for (size_t i = 0; i < view.meshes.size(); ++i) {
    const Mesh& mesh = view.meshes[i];
    if (mesh.skin_vertex_count != 0 && mesh.skin_vertex_count != mesh.vertex_count) {
      return at("meshes", i) + ".skin_vertex_count: " + std::to_string(mesh.skin_vertex_count) +
             " is neither 0 nor its " + std::to_string(mesh.vertex_count) + " vertices";
    }
  }
  const std::vector<uint32_t> asked = joints_asked_by_meshes(view);
  for (size_t i = 0; i < view.instances.size(); ++i) {
    const Instance& instance = view.instances[i];
    if (instance.dynamic == 0 && (instance.skin != none || instance.node != none)) {
      return at("instances", i) + ".dynamic: 0 where a node or a skin moves it";
    }
    if (instance.skin == none) continue;
    const Skin& skin = view.skins[instance.skin];
    if (asked[instance.mesh] > skin.joint_count || asked[instance.mesh] == 0) {
      return at("instances", i) + ".skin: has " + std::to_string(skin.joint_count) + " joints where " +
             at("meshes", instance.mesh) + " asks for " + std::to_string(asked[instance.mesh]);
    }
  }
  return {};
}

}  // namespace

std::string animation_fault(const View& view) {
  for (const auto fault : {node_fault, channel_fault, duration_fault, skin_vertex_fault, skin_fault}) {
    if (std::string line = fault(view); !line.empty()) return line;
  }
  return {};
}

}  // namespace chandelier::pack
