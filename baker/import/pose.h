// SPDX-License-Identifier: Apache-2.0
// Skins that nothing moves: their meshes are baked in the pose of the file's joints.
#pragma once

#include "../scene.h"

namespace chandelier::baker {

/// Where the joints of a skin stand.
struct Pose {
  std::vector<glm::dmat4> world_from_bind;  // one per joint; none where the skin is not used, or moves
  glm::dvec3 origin_ws{0};                  // near its meshes, so that floats are precise
};

/// Moves a mesh, whose joints are below those of the pose, from its bind pose into the world, less pose.origin_ws, and
/// removes its joints. Throws Error, which names `where`, if a float cannot hold a position.
void apply_pose(const Pose& pose, const std::string& where, Mesh& mesh);

}  // namespace chandelier::baker
