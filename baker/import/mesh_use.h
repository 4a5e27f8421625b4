// SPDX-License-Identifier: Apache-2.0
// The meshes that the scene shows, and their shapes (morph weights, poses).
#pragma once

#include <compare>
#include <cstdint>
#include <map>

#include "morph.h"
#include "motion.h"

namespace chandelier::baker {

/// A glTF mesh in one shape. Nodes that show the same one share it.
struct MeshShape {
  size_t mesh = 0;
  uint32_t morph_weights = 0;  // their number among all
  size_t posed_by = SIZE_MAX;  // glTF's number of a skin that nothing moves; SIZE_MAX: of none

  auto operator<=>(const MeshShape&) const = default;
};

struct MeshUse {
  uint32_t number = no_index;  // of Scene::meshes
  size_t first_node = 0;       // that shows it
  bool skinned = false;        // by one node at least
  uint32_t joint_count = 0;    // that its vertices ask for; 0 where not all of them have joints
};

using MeshUses = std::map<MeshShape, MeshUse>;

/// The shape of a node's mesh. It must have one.
inline MeshShape shape_of(const Gltf& gltf, const Motion& motion, MorphWeights& weights, size_t number) {
  const tinygltf::Node& node = gltf.model.nodes[number];
  const bool posed = node.skin >= 0 && !motion.pose[static_cast<size_t>(node.skin)].world_from_bind.empty();
  return {static_cast<size_t>(node.mesh), weights.of_node(number), posed ? static_cast<size_t>(node.skin) : SIZE_MAX};
}

}  // namespace chandelier::baker
