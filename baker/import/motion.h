// SPDX-License-Identifier: Apache-2.0
// Animated nodes, joints, and everything below them.
#pragma once

#include <cstdint>

#include "nodes.h"
#include "pose.h"

namespace chandelier::baker {

/// By glTF's numbers of nodes and skins.
struct Motion {
  std::vector<uint32_t> node;      // of Scene::nodes, or no_index
  std::vector<uint8_t> moves;      // whether an animation moves it or a node above it
  std::vector<uint32_t> skin;      // of Scene::skins, or no_index: it is not used, or nothing moves its joints
  std::vector<Pose> pose;          // of each skin that is used and whose joints nothing moves
  std::vector<glm::dmat4> placed;  // of each other one: from its mesh to the world, where its first joint puts it

  /// The number of a node that moves, or no_index.
  uint32_t mover(size_t gltf_node) const { return moves[gltf_node] ? node[gltf_node] : no_index; }
};

/// Appends animations, the skins that are used and that they move, and the nodes that both need. Throws Error.
Motion add_motion(const Gltf& gltf, const std::vector<PlacedNode>& placed, Scene& scene, Warnings& warnings);

}  // namespace chandelier::baker
