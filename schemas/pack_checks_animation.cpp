// SPDX-License-Identifier: Apache-2.0
// Nodes, animations and skins: what a player that evaluates them relies on, so that it ends and reads nothing wild.
#include "pack_checks_animation.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace chandelier::pack {
namespace {

constexpr float unit_tolerance = 1e-3f;

std::string at(const char* section, std::size_t i) {
  return std::string(section) + "[" + std::to_string(i) + "]";
}

std::string node_fault(const View& view) {
  for (std::size_t i = 0; i < view.nodes.size(); ++i) {
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

std::string channel_fault(const View& view) {
  for (std::size_t i = 0; i < view.animation_channels.size(); ++i) {
    const AnimationChannel& channel = view.animation_channels[i];
    const std::uint64_t components = channel.path == AnimationPath::rotation ? 4 : 3;
    const std::uint64_t values = channel.interpolation == Interpolation::cubic_spline ? 3 : 1;
    const std::uint64_t expected = channel.key_count * components * values;
    if (channel.value_count != expected) {
      return at("animation_channels", i) + ".value_count: " + std::to_string(channel.value_count) +
             " where its keys have " + std::to_string(expected);
    }
    for (std::size_t k = 1; k < channel.key_count; ++k) {
      if (view.animation_times[channel.first_key + k].time_s > view.animation_times[channel.first_key + k - 1].time_s) {
        continue;
      }
      return at("animation_times", channel.first_key + k) + ".time_s: does not ascend in " +
             at("animation_channels", i);
    }
  }
  return {};
}

std::string duration_fault(const View& view) {
  for (std::size_t i = 0; i < view.animations.size(); ++i) {
    const Animation& animation = view.animations[i];
    for (std::size_t c = 0; c < animation.channel_count; ++c) {
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

/// The number of the joint after the last that a mesh asks for.
std::uint32_t joints_asked(const View& view, const Mesh& mesh) {
  std::uint32_t end = 0;
  for (std::size_t v = 0; v < mesh.skin_vertex_count; ++v) {
    for (const std::uint32_t pair : view.skin_vertices[mesh.first_skin_vertex + v].joints) {
      end = std::max(end, 1 + std::max(pair & 0xFFFFu, pair >> 16));
    }
  }
  return end;
}

std::string skin_vertex_fault(const View& view) {
  for (std::size_t i = 0; i < view.skin_vertices.size(); ++i) {
    std::uint32_t sum = 0;
    for (const std::uint32_t pair : view.skin_vertices[i].weights) sum += (pair & 0xFFFFu) + (pair >> 16);
    if (sum != 65535) return at("skin_vertices", i) + ".weights: sum to " + std::to_string(sum) + ", not 65535";
  }
  return {};
}

/// Every mesh's joints are looked at once, however many instances and skins it has.
std::string skin_fault(const View& view) {
  std::vector<std::uint32_t> asked(view.meshes.size());
  for (std::size_t i = 0; i < asked.size(); ++i) {
    const Mesh& mesh = view.meshes[i];
    if (mesh.skin_vertex_count != 0 && mesh.skin_vertex_count != mesh.vertex_count) {
      return at("meshes", i) + ".skin_vertex_count: " + std::to_string(mesh.skin_vertex_count) +
             " is neither 0 nor its " + std::to_string(mesh.vertex_count) + " vertices";
    }
    asked[i] = joints_asked(view, mesh);
  }
  for (std::size_t i = 0; i < view.instances.size(); ++i) {
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
