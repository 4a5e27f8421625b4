// SPDX-License-Identifier: Apache-2.0
// Node transforms and cameras.
#include "nodes.h"

#include <algorithm>
#include <cmath>
#include <glm/gtc/quaternion.hpp>

namespace chandelier::baker {
namespace {

// Slightly wider than 1e-9 to 1e9, so that both limits are still baked. 1e-9 cubed, flattened by another 1e-9, is still
// a normal float.
constexpr double least_scale = 0.999e-9, most_scale = 1.001e9;

glm::dmat4 local_transform(const tinygltf::Node& node, const std::string& where) {
  glm::dmat4 out(1);
  if (!node.matrix.empty()) {
    for (int column = 0; column < 4; ++column) {  // both column-major; the last row is checked: 0, 0, 0, 1
      for (int row = 0; row < 3; ++row) out[column][row] = node.matrix[4 * column + row];
    }
    return out;
  }
  if (!node.rotation.empty()) {
    const auto& r = node.rotation;
    const glm::dquat rotation(r[3], r[0], r[1], r[2]);  // glm: w first
    const double length = glm::length(rotation);
    if (!(length > 1e-12)) fail(where + ", rotation", "has no direction (length " + to_text(length) + ")");
    out = glm::mat4_cast(rotation / length);
  }
  for (int c = 0; c < 3 && !node.scale.empty(); ++c) out[c] *= node.scale[c];
  for (int c = 0; c < 3 && !node.translation.empty(); ++c) out[3][c] = node.translation[c];
  return out;
}

/// KHR_node_visibility.
bool is_visible(const Gltf& gltf, size_t node) {
  static const Json::json_pointer pointer("/extensions/KHR_node_visibility/visible");
  return gltf.json["nodes"][node].value(pointer, true);
}

std::vector<size_t> root_nodes(const Gltf& gltf, std::optional<size_t> scene) {
  const tinygltf::Model& model = gltf.model;
  if (scene) {
    const auto& nodes = model.scenes[*scene].nodes;
    return {nodes.begin(), nodes.end()};
  }
  std::vector<uint8_t> is_child(model.nodes.size(), 0);
  for (const tinygltf::Node& node : model.nodes) {
    for (int child : node.children) is_child[child] = 1;
  }
  std::vector<size_t> roots;
  for (size_t i = 0; i < is_child.size(); ++i) {
    if (!is_child[i]) roots.push_back(i);
  }
  return roots;
}

}  // namespace

void check_place(const glm::dmat4& m, const std::string& where) {
  for (int i = 0; i < 16; ++i) {
    const double value = m[i / 4][i % 4];
    if (!std::isfinite(static_cast<float>(value))) {
      fail(where, "its position in the world is too large for a float (" + to_text(value) + ")");
    }
  }
}

glm::dvec3 world_direction(const glm::dmat4& world, const glm::dvec3& local) {
  const glm::dvec3 direction = glm::dmat3(world) * local;
  const double length = glm::length(direction);
  return length > 1e-30 ? direction / length : glm::dvec3(0);
}

std::string name_of(const tinygltf::Node& node, const std::string& own) {
  return node.name.empty() ? own : node.name;
}

std::vector<PlacedNode> place_nodes(const Gltf& gltf, std::optional<size_t> scene) {
  std::vector<PlacedNode> out;
  std::vector<uint8_t> seen(gltf.model.nodes.size(), 0);
  std::vector<PlacedNode> open;  // a stack of nodes with their parents' transforms: any depth
  const auto roots = root_nodes(gltf, scene);
  for (auto it = roots.rbegin(); it != roots.rend(); ++it) open.push_back({*it, glm::dmat4(1)});
  while (!open.empty()) {
    PlacedNode placed = open.back();
    open.pop_back();
    const std::string where = gltf.file + ": " + place(gltf.json, "nodes", placed.node);
    if (seen[placed.node]) fail(where, "is in the scene twice");
    seen[placed.node] = 1;
    const tinygltf::Node& node = gltf.model.nodes[placed.node];
    placed.parent_from_local = local_transform(node, where);
    placed.world_from_local = placed.world_from_local * placed.parent_from_local;
    check_place(placed.world_from_local, where);
    placed.visible = placed.visible && is_visible(gltf, placed.node);
    out.push_back(placed);
    for (auto it = node.children.rbegin(); it != node.children.rend(); ++it) {
      open.push_back({static_cast<size_t>(*it), placed.world_from_local, glm::dmat4(1), placed.node, placed.visible});
    }
  }
  return out;
}

bool is_degenerate(const glm::dmat4& transform) {
  const glm::dmat3 linear(transform);
  double volume = 1;
  for (int axis = 0; axis < 3; ++axis) {
    const double length = glm::length(linear[axis]);
    if (!(length > least_scale && length < most_scale)) return true;
    volume *= length;
  }
  return !(std::abs(glm::determinant(linear)) > 1e-9 * volume);
}

void add_camera(const Gltf& gltf, const PlacedNode& placed, Scene& scene, Warnings& warnings) {
  const tinygltf::Node& node = gltf.model.nodes[placed.node];
  if (node.camera < 0) return;
  const tinygltf::Camera& in = gltf.model.cameras[static_cast<size_t>(node.camera)];
  const std::string here = place(gltf.json, "nodes", placed.node);
  if (in.type != "perspective") {
    warnings.add(gltf.file, here, "an orthographic camera is skipped");
    return;
  }
  const double yfov = in.perspective.yfov;
  if (!(yfov >= 1e-4 && yfov <= 3.1)) {  // a pack's limits; a straight angle would be pi
    warnings.add(gltf.file, here, "a camera whose yfov is not within 0.0001 to 3.1 is skipped");
    return;
  }
  const glm::dvec3 forward = world_direction(placed.world_from_local, {0, 0, -1});
  const glm::dvec3 up = world_direction(placed.world_from_local, {0, 1, 0});
  const glm::dvec3 across = up - forward * glm::dot(up, forward);
  if (forward == glm::dvec3(0) || !(glm::length(across) > 1e-9)) {
    warnings.add(gltf.file, here, "a camera whose node has zero scale is skipped");
    return;
  }
  Camera out;
  out.name = name_of(node, in.name);
  out.position_ws = glm::dvec3(placed.world_from_local[3]);
  out.forward_ws = glm::vec3(forward);
  out.up_ws = glm::vec3(glm::normalize(across));
  out.yfov_rad = static_cast<float>(in.perspective.yfov);
  out.aspect = static_cast<float>(in.perspective.aspectRatio);
  out.znear_m = static_cast<float>(in.perspective.znear);
  scene.cameras.push_back(std::move(out));
}

}  // namespace chandelier::baker
