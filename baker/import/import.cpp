// SPDX-License-Identifier: Apache-2.0
// Appends one glTF file to the scene: nodes, and what they use of meshes and materials.
#include "import.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <glm/ext/matrix_transform.hpp>
#include <set>

#include "extras.h"
#include "geometry.h"
#include "gltf.h"
#include "instancing.h"
#include "lights.h"
#include "materials.h"
#include "mesh_use.h"
#include "nodes.h"
#include "scenes.h"

namespace chandelier::baker {
namespace {

constexpr size_t most_instances = size_t{1} << 24;  // a few bytes of a file can stand for many

struct Import {
  Gltf& gltf;
  Scene& scene;
  Warnings& warnings;
  Motion motion;
  MorphWeights morphs;
  MeshUses meshes;
  std::vector<const MeshShape*> mesh_order;  // as the scene has them
  ImportCounts counts;
  std::set<size_t> lights;  // that nodes have, as the file numbers them
};

uint32_t skin_of(const Import& in, const tinygltf::Node& node) {
  return node.skin < 0 ? no_index : in.motion.skin[static_cast<size_t>(node.skin)];
}

/// The pose of the node's skin if nothing moves that; else nullptr.
const Pose* pose_of(const Import& in, const tinygltf::Node& node) {
  if (node.skin < 0) return nullptr;
  const Pose& pose = in.motion.pose[static_cast<size_t>(node.skin)];
  return pose.world_from_bind.empty() ? nullptr : &pose;
}

/// A mesh with a skin is placed by its joints, wherever its node is (glTF 2.0, 3.7.3.3). If nothing moves them, its
/// vertices are baked in place. Otherwise the mesh stays in its bind pose, and the first joint places it as a whole.
glm::dmat4 place_of_mesh(const Import& in, const PlacedNode& placed) {
  const tinygltf::Node& node = in.gltf.model.nodes[placed.node];
  if (const Pose* pose = pose_of(in, node)) return glm::translate(glm::dmat4(1), pose->origin_ws);
  if (skin_of(in, node) == no_index) return placed.world_from_local;
  const glm::dmat4& by_joint = in.motion.placed[static_cast<size_t>(node.skin)];
  return is_degenerate(by_joint) ? placed.world_from_local : by_joint;
}

/// Whether a transform without volume occurs only in the rest pose. Copies (EXT_mesh_gpu_instancing) need the inverse
/// of their node's transform.
bool may_grow(const Import& in, const PlacedNode& placed) {
  const tinygltf::Node& node = in.gltf.model.nodes[placed.node];
  if (node.extensions.contains("EXT_mesh_gpu_instancing")) return false;
  if (skin_of(in, node) == no_index) return in.motion.moves[placed.node];
  const Json& joints = in.gltf.json["skins"][static_cast<size_t>(node.skin)]["joints"];
  return std::any_of(joints.begin(), joints.end(),
                     [&](const Json& joint) { return in.motion.moves[joint.get<size_t>()] != 0; });
}

void warn_of_scale(const Import& in, const PlacedNode& placed) {
  in.warnings.add(in.gltf.file, place(in.gltf.json, "nodes", placed.node),
                  "a mesh whose scale is zero or not within 1e-9 to 1e9 is skipped");
}

/// Warns that the node's mesh or light is left out; cameras never are.
void count_hidden(Import& in, const PlacedNode& placed) {
  const tinygltf::Node& node = in.gltf.model.nodes[placed.node];
  if (node.mesh < 0 && !node.extensions.contains("KHR_lights_punctual")) return;
  ++in.counts.hidden_nodes;
  in.warnings.add(in.gltf.file, "nodes", "meshes and lights hidden by KHR_node_visibility are left out",
                  place(in.gltf.json, "nodes", placed.node));
}

/// Everything but meshes; notes which meshes are used.
void visit_node(Import& in, const PlacedNode& placed) {
  const tinygltf::Node& node = in.gltf.model.nodes[placed.node];
  const size_t lights = in.scene.lights.size(), cameras = in.scene.cameras.size();
  if (placed.visible) add_light(in.gltf, placed, in.lights, in.scene, in.warnings);
  add_camera(in.gltf, placed, in.scene, in.warnings);
  const uint32_t mover = in.motion.mover(placed.node);
  if (in.scene.lights.size() > lights) {
    in.scene.lights.back().node = mover;
    in.scene.lights.back().dynamic = in.scene.lights.back().dynamic || mover != no_index;
  }
  if (in.scene.cameras.size() > cameras) in.scene.cameras.back().node = mover;
  if (!placed.visible) return count_hidden(in, placed);
  if (node.mesh < 0) return;
  if (is_degenerate(place_of_mesh(in, placed)) && !may_grow(in, placed)) return warn_of_scale(in, placed);
  const auto [it, added] = in.meshes.try_emplace(shape_of(in.gltf, in.motion, in.morphs, placed.node));
  MeshUse& use = it->second;
  use.skinned = use.skinned || skin_of(in, node) != no_index || pose_of(in, node);
  if (!added) return;
  use.first_node = placed.node;
  use.number = fit_u32(in.scene.meshes.size() + in.mesh_order.size(), "meshes");
  in.mesh_order.push_back(&it->first);
}

/// Refuses geometry that is too large, before any of it takes memory.
void check_size(const Import& in) {
  GeometrySize total;
  for (const MeshShape* shape : in.mesh_order) {
    for (size_t p = 0; p < in.gltf.model.meshes[shape->mesh].primitives.size(); ++p) {
      add_size(in.gltf, shape->mesh, p, in.morphs[shape->morph_weights], total);
    }
  }
}

std::vector<std::vector<ReadPrimitive>> read_primitives(const Import& in) {
  std::vector<std::vector<ReadPrimitive>> out(in.mesh_order.size());
  std::vector<std::pair<size_t, size_t>> jobs;  // mesh in order, primitive
  for (size_t m = 0; m < out.size(); ++m) {
    out[m].resize(in.gltf.model.meshes[in.mesh_order[m]->mesh].primitives.size());
    for (size_t p = 0; p < out[m].size(); ++p) jobs.emplace_back(m, p);
  }
  tbb::parallel_for(size_t{0}, jobs.size(), [&](size_t i) {
    const auto [m, p] = jobs[i];
    const MeshShape& shape = *in.mesh_order[m];
    out[m][p] = read_primitive(in.gltf, shape.mesh, p, in.meshes.at(shape).skinned, in.morphs[shape.morph_weights]);
  });
  return out;
}

/// Returns the number of joints that a mesh refers to. If a vertex has none, removes all joints and returns 0.
uint32_t settle_joints(Mesh& mesh) {
  uint32_t count = 0;
  const bool all = std::all_of(mesh.primitives.begin(), mesh.primitives.end(), [](const Primitive& primitive) {
    return primitive.skin_vertices.size() == primitive.vertices.size();
  });
  for (Primitive& primitive : mesh.primitives) {
    if (!all) primitive.skin_vertices.clear();
    for (const SkinVertex& vertex : primitive.skin_vertices) {
      count = std::max(count, 1u + *std::max_element(vertex.joints.begin(), vertex.joints.end()));
    }
  }
  return count;
}

/// Throws Error if a node's mesh refers to joints that its skin lacks.
void check_joints(const Import& in, size_t node, uint32_t asked, size_t joints) {
  if (asked <= joints) return;
  fail(in.gltf.file + ": " + place(in.gltf.json, "nodes", node),
       "its mesh uses joints that its skin lacks; the skin's number of joints is " + std::to_string(joints) + " (" +
           std::to_string(asked - 1) + ")");
}

void add_mesh(Import& in, const MeshShape& shape, std::vector<ReadPrimitive>&& read, Materials& materials) {
  Mesh mesh;
  for (size_t p = 0; p < read.size(); ++p) {
    for (const std::string& warning : read[p].warnings) {
      in.warnings.add(in.gltf.file, place_of_primitive(in.gltf, shape.mesh, p), warning);
    }
    if (!read[p].error.empty()) throw Error(read[p].error);
    if (!read[p].primitive) continue;
    Primitive& primitive = *read[p].primitive;
    primitive.material = materials.use(in.gltf.model.meshes[shape.mesh].primitives[p].material);
    const Material& material = in.scene.materials[primitive.material];
    primitive.needs_tangents = primitive.needs_tangents && material.normal.texture != no_index;
    primitive.tangents_from_uv1 = material.normal.uv1;
    mesh.primitives.push_back(std::move(primitive));
  }
  MeshUse& use = in.meshes.at(shape);
  if (use.skinned) use.joint_count = settle_joints(mesh);
  if (shape.posed_by != SIZE_MAX && use.joint_count > 0) {
    const Pose& pose = in.motion.pose[shape.posed_by];
    check_joints(in, use.first_node, use.joint_count, pose.world_from_bind.size());
    apply_pose(pose, in.gltf.file + ": " + place(in.gltf.json, "meshes", shape.mesh), mesh);
  }
  in.scene.meshes.push_back(std::move(mesh));
}

/// Places the instance by its mesh's skin, if it has one and its mesh has joints. Throws Error if the mesh uses joints
/// that the skin lacks.
void place_by_skin(const Import& in, const PlacedNode& placed, const MeshUse& mesh, MeshInstance& instance) {
  const tinygltf::Node& node = in.gltf.model.nodes[placed.node];
  const uint32_t skin = skin_of(in, node);
  const bool posed = pose_of(in, node) != nullptr;
  if (skin == no_index && !posed) return;
  if (mesh.joint_count == 0) {
    in.warnings.add(in.gltf.file, place(in.gltf.json, "nodes", placed.node),
                    "a skin is ignored: its mesh has vertices without joints");
    return;
  }
  if (posed) {
    instance.node = no_index;  // glTF ignores the node's transform
  } else {
    check_joints(in, placed.node, mesh.joint_count, in.scene.skins[skin].joints.size());
  }
  instance.skin = skin;
  instance.world_from_local = place_of_mesh(in, placed);
}

void add_instances(Import& in, const PlacedNode& placed) {
  const tinygltf::Node& node = in.gltf.model.nodes[placed.node];
  const bool shadowless = is_shadowless(in.gltf, placed.node, in.warnings);
  if (node.mesh < 0 || !placed.visible) return;
  if (is_degenerate(place_of_mesh(in, placed)) && !may_grow(in, placed)) return;
  const MeshUse& mesh = in.meshes.at(shape_of(in.gltf, in.motion, in.morphs, placed.node));
  const std::string here = place(in.gltf.json, "nodes", placed.node), where = in.gltf.file + ": " + here;
  MeshInstance instance{node.name, where, placed.world_from_local, mesh.number, in.motion.mover(placed.node)};
  instance.shadowless = shadowless;
  place_by_skin(in, placed, mesh, instance);
  const bool skinned = instance.skin != no_index || (pose_of(in, node) && mesh.joint_count > 0);
  const bool grows = instance.node != no_index || instance.skin != no_index;
  if (is_degenerate(instance.world_from_local) && !grows) return warn_of_scale(in, placed);
  const auto places = read_instances(in.gltf, placed.node);
  if (!places || skinned) {
    if (places) in.warnings.add(in.gltf.file, here, "EXT_mesh_gpu_instancing on a mesh with a skin is ignored");
    in.scene.instances.push_back(std::move(instance));
    return;
  }
  if (in.scene.instances.size() + places->size() > most_instances) {
    fail(where, "more than " + std::to_string(most_instances) + " instances (" +
                    std::to_string(in.scene.instances.size() + places->size()) + ")");
  }
  for (const glm::dmat4& each : *places) {
    instance.world_from_local = placed.world_from_local * each;
    check_place(instance.world_from_local, where);
    if (is_degenerate(instance.world_from_local)) {
      in.warnings.add(in.gltf.file, here, "instances whose scale is zero or not within 1e-9 to 1e9 are skipped");
      continue;
    }
    in.scene.instances.push_back(instance);
  }
}

ImportCounts import_file(const std::filesystem::path& path, Scene& scene, Warnings& warnings,
                         const ImportSettings& settings) {
  Gltf gltf = read_gltf(path, warnings);
  scene.sources.push_back(path.filename().string());
  const ChosenScene chosen = choose_scene(gltf, settings.scene, warnings);
  const std::vector<PlacedNode> nodes = place_nodes(gltf, chosen.number);
  Motion motion = add_motion(gltf, nodes, scene, warnings);
  Import in{gltf, scene, warnings, std::move(motion), MorphWeights(gltf), {}, {}, {}, {}};
  for (const PlacedNode& placed : nodes) visit_node(in, placed);
  check_size(in);
  std::vector<std::vector<ReadPrimitive>> primitives = read_primitives(in);
  Materials materials(gltf, scene, warnings);
  for (size_t m = 0; m < primitives.size(); ++m) {
    add_mesh(in, *in.mesh_order[m], std::move(primitives[m]), materials);
  }
  for (const PlacedNode& placed : nodes) add_instances(in, placed);
  materials.warn();
  warn_of_buffers(gltf, warnings);
  scene.files_read.insert(scene.files_read.end(), gltf.files_read.begin(), gltf.files_read.end());
  in.counts.has_scene = chosen.asked_for;
  in.counts.scenes_left_out = chosen.left_out;
  in.counts.converted_materials = materials.converted();
  return in.counts;
}

}  // namespace

ImportCounts import_gltf(const std::filesystem::path& path, Scene& scene, Warnings& warnings,
                         const ImportSettings& settings) {
  try {
    return import_file(path, scene, warnings, settings);
  } catch (const Json::exception& error) {  // from a key that no check covers
    fail(path.string(), std::string("is not a glTF that can be read: ") + error.what());
  }
}

}  // namespace chandelier::baker
