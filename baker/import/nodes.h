// SPDX-License-Identifier: Apache-2.0
// The node tree: where meshes, lights and cameras stand in the world; cameras.
#pragma once

#include <cstddef>
#include <optional>

#include "../scene.h"
#include "gltf.h"

namespace chandelier::baker {

struct PlacedNode {
  size_t node;
  glm::dmat4 world_from_local;
  glm::dmat4 parent_from_local{1};
  size_t parent = SIZE_MAX;  // the node above it
  bool visible = true;       // it and all above it (KHR_node_visibility)
};

/// The nodes of a scene (all roots where there is none), parents first. Throws Error.
std::vector<PlacedNode> place_nodes(const Gltf& gltf, std::optional<size_t> scene);

/// Appends the node's camera to the scene, where it has one. Throws Error.
void add_camera(const Gltf& gltf, const PlacedNode& placed, Scene& scene, Warnings& warnings);

/// A direction of the node in the world, or zero where the transform leaves none.
glm::dvec3 world_direction(const glm::dmat4& world, const glm::dvec3& local);

/// The node's name, else the light's or camera's own.
std::string name_of(const tinygltf::Node& node, const std::string& own);

/// Throws Error where a float cannot hold the transform.
void check_place(const glm::dmat4& world_from_local, const std::string& where);

/// Whether the transform flattens space, so that normals and winding have no meaning, or scales an axis by less than
/// 1e-9 or more than 1e9, so that it would be flat or infinite in floats.
bool is_degenerate(const glm::dmat4& transform);

}  // namespace chandelier::baker
