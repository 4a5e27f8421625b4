// SPDX-License-Identifier: Apache-2.0
// Scene::nodes holds only what a runtime needs in order to pose: animated nodes, joints, nodes that carry something and
// move, and all nodes above these.
#include "motion.h"

#include <algorithm>
#include <cmath>
#include <glm/gtc/quaternion.hpp>

#include "accessor.h"
#include "animation.h"

namespace chandelier::baker {
namespace {

using Flags = std::vector<uint8_t>;

bool carries(const tinygltf::Node& node, bool visible) {
  if (node.camera >= 0) return true;
  return visible && (node.mesh >= 0 || node.extensions.contains("KHR_lights_punctual"));
}

/// Decomposes the matrix of a rest pose. An approximation is enough, since nothing animates such a node.
void decompose(const glm::dmat4& m, Node& out) {
  out.translation = glm::dvec3(m[3]);
  glm::dmat3 axes(m);
  if (glm::determinant(axes) < 0) axes[0] = -axes[0];
  for (int c = 0; c < 3; ++c) {
    const double length = glm::length(axes[c]);
    out.scale[c] = static_cast<float>(c == 0 && glm::determinant(glm::dmat3(m)) < 0 ? -length : length);
    if (length > 0) axes[c] /= length;
  }
  const glm::dquat q = glm::quat_cast(axes);
  const double length = glm::length(q);
  if (length > 1e-6 && std::isfinite(length)) out.rotation = glm::vec4(glm::dvec4(q.x, q.y, q.z, q.w) / length);
}

Node node_record(const tinygltf::Node& in, const glm::dmat4& parent_from_local) {
  Node out;
  out.name = in.name;
  out.parent_from_local = parent_from_local;
  if (!in.matrix.empty()) {
    decompose(parent_from_local, out);
    return out;
  }
  for (int c = 0; c < 3 && !in.translation.empty(); ++c) out.translation[c] = in.translation[c];
  for (int c = 0; c < 3 && !in.scale.empty(); ++c) out.scale[c] = static_cast<float>(in.scale[c]);
  if (in.rotation.empty()) return out;
  const glm::dvec4 rotation(in.rotation[0], in.rotation[1], in.rotation[2], in.rotation[3]);
  out.rotation = glm::vec4(rotation / glm::length(rotation));  // its length was checked with its transform
  return out;
}

/// Rows and columns as glTF has them: columns first.
glm::mat4 matrix_at(const std::vector<float>& values, size_t i) {
  glm::mat4 out;
  for (int k = 0; k < 16; ++k) out[k / 4][k % 4] = values[16 * i + static_cast<size_t>(k)];
  return out;
}

std::vector<glm::mat4> read_bind_matrices(const Gltf& gltf, const Json& skin, const std::string& where) {
  const size_t joints = skin["joints"].size();
  std::vector<glm::mat4> out(joints, glm::mat4(1));
  if (!skin.contains("inverseBindMatrices")) return out;
  const int accessor = skin["inverseBindMatrices"].get<int>();
  const std::string here = where + ", inverseBindMatrices";
  if (gltf.model.accessors[static_cast<size_t>(accessor)].componentType != TINYGLTF_COMPONENT_TYPE_FLOAT) {
    fail(here, "component type is not float");
  }
  const Floats floats = read_floats(gltf, accessor, 16, 16, here);
  if (floats.count < joints) {
    fail(here, "has fewer matrices than there are joints, " + std::to_string(joints) + " (" +
                   std::to_string(floats.count) + ")");
  }
  for (size_t i = 0; i < joints; ++i) {
    out[i] = matrix_at(floats.values, i);
    for (int c = 0; c < 4; ++c) {
      if (std::abs(out[i][c][3] - (c == 3 ? 1.0f : 0.0f)) <= 1e-4f) continue;
      fail(here, "the last row of a matrix is not 0, 0, 0, 1 (" + to_text(out[i][c][3]) + " in matrix " +
                     std::to_string(i) + ")");
    }
  }
  return out;
}

/// Which skins a mesh in the scene has. One with a joint outside of the scene is left out.
Flags used_skins(const Gltf& gltf, const std::vector<PlacedNode>& placed, const Flags& in_scene, Warnings& warnings) {
  Flags used(gltf.json.contains("skins") ? gltf.json["skins"].size() : 0, 0);
  for (const PlacedNode& each : placed) {
    const tinygltf::Node& node = gltf.model.nodes[each.node];
    if (each.visible && node.skin >= 0 && node.mesh >= 0) used[static_cast<size_t>(node.skin)] = 1;
  }
  for (size_t s = 0; s < used.size(); ++s) {
    for (const Json& joint : gltf.json["skins"][s]["joints"]) {
      if (!used[s] || in_scene[joint.get<size_t>()]) continue;
      warnings.add(gltf.file, place(gltf.json, "skins", s), "a joint is not in the scene, so the skin is ignored");
      used[s] = 0;
    }
  }
  return used;
}

/// Whether an animation moves one of a skin's joints.
bool moves(const Motion& motion, const Json& skin) {
  return std::any_of(skin["joints"].begin(), skin["joints"].end(),
                     [&](const Json& joint) { return motion.moves[joint.get<size_t>()] != 0; });
}

/// Whether the joints show a mesh in its bind pose, moved as a whole. `places`: the positions of the joints in the
/// world. The tolerance depends on the skin's size around its first joint, not on its distance from the origin.
bool is_bind_pose(const std::vector<glm::dmat4>& world_from_bind, const std::vector<glm::dvec3>& places) {
  constexpr double rounding = 1e-4, least_m = 0.01;  // of inverse bind matrices, which are floats
  const auto largest = [](const glm::dvec3& v) { return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)}); };
  const glm::dmat4& first = world_from_bind[0];
  double scale = 0, size_m = std::max(least_m, largest(glm::dvec3(first[3]) - places[0]));
  for (int c = 0; c < 3; ++c) scale = std::max(scale, largest(glm::dvec3(first[c])));
  for (const glm::dvec3& place : places) size_m = std::max(size_m, largest(place - places[0]));
  return std::all_of(world_from_bind.begin(), world_from_bind.end(), [&](const glm::dmat4& each) {
    for (int c = 0; c < 4; ++c) {
      if (largest(glm::dvec3(each[c]) - glm::dvec3(first[c])) > rounding * (c == 3 ? size_m : scale)) return false;
    }
    return true;
  });
}

/// Adds skins whose joints an animation moves to the scene; keeps only the pose of the others.
void add_skin(const Gltf& gltf, size_t number, const std::vector<glm::dmat4>& world, Motion& motion, Scene& scene,
              Warnings& warnings) {
  const Json& json = gltf.json["skins"][number];
  const std::string here = place(gltf.json, "skins", number);
  const auto matrices = read_bind_matrices(gltf, json, gltf.file + ": " + here);
  Pose pose;
  std::vector<glm::dvec3> places;
  Skin skin;
  skin.name = json.value("name", "");
  for (size_t i = 0; i < matrices.size(); ++i) {
    const auto node = json["joints"][i].get<size_t>();
    pose.world_from_bind.push_back(world[node] * glm::dmat4(matrices[i]));
    places.emplace_back(world[node][3]);
    skin.joints.push_back({motion.node[node], matrices[i]});
  }
  pose.origin_ws = places[0];
  if (!moves(motion, json)) {
    motion.pose[number] = std::move(pose);
    return;
  }
  if (!is_bind_pose(pose.world_from_bind, places)) {
    warnings.add(gltf.file, here, "animation of a skin is not played: its meshes are shown in their bind pose");
  }
  motion.placed[number] = pose.world_from_bind[0];
  motion.skin[number] = fit_u32(scene.skins.size(), "skins");
  scene.skins.push_back(std::move(skin));
}

/// Flags the node and all above it.
void keep(size_t node, const std::vector<size_t>& parents, Flags& kept) {
  for (; node != SIZE_MAX && !kept[node]; node = parents[node]) kept[node] = 1;
}

}  // namespace

Motion add_motion(const Gltf& gltf, const std::vector<PlacedNode>& placed, Scene& scene, Warnings& warnings) {
  const size_t count = gltf.model.nodes.size();
  Motion motion{std::vector<uint32_t>(count, no_index), Flags(count, 0), {}, {}, {}};
  Flags in_scene(count, 0), kept(count, 0);
  std::vector<size_t> parents(count, SIZE_MAX);
  std::vector<glm::dmat4> world(count);
  for (const PlacedNode& each : placed) {
    in_scene[each.node] = 1;
    parents[each.node] = each.parent;
    world[each.node] = each.world_from_local;
  }
  std::vector<Animation> animations = read_animations(gltf, in_scene, warnings);
  for (const Animation& animation : animations) {
    for (const AnimationChannel& channel : animation.channels) {
      motion.moves[channel.node] = 1;
      keep(channel.node, parents, kept);
    }
  }
  for (const PlacedNode& each : placed) {  // parents first
    if (each.parent != SIZE_MAX && motion.moves[each.parent]) motion.moves[each.node] = 1;
    if (motion.moves[each.node] && carries(gltf.model.nodes[each.node], each.visible)) keep(each.node, parents, kept);
  }
  const Flags used = used_skins(gltf, placed, in_scene, warnings);
  for (size_t s = 0; s < used.size(); ++s) {
    if (!used[s] || !moves(motion, gltf.json["skins"][s])) continue;
    for (const Json& joint : gltf.json["skins"][s]["joints"]) keep(joint.get<size_t>(), parents, kept);
  }
  for (const PlacedNode& each : placed) {
    if (!kept[each.node]) continue;
    motion.node[each.node] = fit_u32(scene.nodes.size(), "nodes");
    scene.nodes.push_back(node_record(gltf.model.nodes[each.node], each.parent_from_local));
    if (each.parent != SIZE_MAX) scene.nodes.back().parent = motion.node[each.parent];
  }
  motion.skin.assign(used.size(), no_index);
  motion.pose.resize(used.size());
  motion.placed.assign(used.size(), glm::dmat4(1));
  for (size_t s = 0; s < used.size(); ++s) {
    if (used[s]) add_skin(gltf, s, world, motion, scene, warnings);
  }
  for (Animation& animation : animations) {
    for (AnimationChannel& channel : animation.channels) channel.node = motion.node[channel.node];
    scene.animations.push_back(std::move(animation));
  }
  return motion;
}

}  // namespace chandelier::baker
