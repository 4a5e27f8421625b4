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
  uint32_t morph_weights = 0;  // their number in MorphWeights
  size_t posed_by = SIZE_MAX;  // glTF's number of its skin, if nothing moves that; else SIZE_MAX

  auto operator<=>(const MeshShape&) const = default;
};

struct MeshUse {
  uint32_t number = no_index;  // of Scene::meshes
  size_t first_node = 0;       // the first node that shows it
  bool skinned = false;        // whether at least one node shows it with a skin
  uint32_t joint_count = 0;    // that its vertices refer to; 0 if some of them have no joints
};

using MeshUses = std::map<MeshShape, MeshUse>;

/// The shape of a node's mesh. It must have one.
inline MeshShape shape_of(const Gltf& gltf, const Motion& motion, MorphWeights& weights, size_t number) {
  const tinygltf::Node& node = gltf.model.nodes[number];
  const bool posed = node.skin >= 0 && !motion.pose[static_cast<size_t>(node.skin)].world_from_bind.empty();
  return {static_cast<size_t>(node.mesh), weights.of_node(number), posed ? static_cast<size_t>(node.skin) : SIZE_MAX};
}

}  // namespace chandelier::baker
