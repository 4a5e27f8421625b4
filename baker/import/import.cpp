// SPDX-License-Identifier: Apache-2.0
// Appends one glTF file to the scene: nodes, and what they use of meshes and materials.
#include "import.h"

#include "geometry.h"
#include "gltf.h"
#include "lights.h"
#include "materials.h"
#include "nodes.h"

namespace chandelier::baker {
namespace {

std::uint32_t add_mesh(const Gltf& gltf, std::size_t index, Materials& materials, Scene& scene, Warnings& warnings) {
  const tinygltf::Mesh& in = gltf.model.meshes[index];
  Mesh mesh;
  for (std::size_t p = 0; p < in.primitives.size(); ++p) {
    auto primitive = read_primitive(gltf, index, p, warnings);
    if (!primitive) continue;
    primitive->material = materials.use(in.primitives[p].material);
    const Material& material = scene.materials[primitive->material];
    primitive->needs_tangents = primitive->needs_tangents && material.normal.texture != kNone;
    primitive->tangents_from_uv1 = material.normal.uv1;
    mesh.primitives.push_back(std::move(*primitive));
  }
  scene.meshes.push_back(std::move(mesh));
  return fit_u32(scene.meshes.size() - 1, "meshes");
}

bool draws_a_mesh(const tinygltf::Node& node, const PlacedNode& placed) {
  return node.mesh >= 0 && !is_degenerate(placed.world_from_local);
}

/// Refuses geometry that is too large, before any of it takes memory.
void check_size(const Gltf& gltf, const std::vector<PlacedNode>& nodes) {
  GeometrySize total;
  std::vector<std::uint8_t> counted(gltf.model.meshes.size(), 0);
  for (const PlacedNode& placed : nodes) {
    const tinygltf::Node& node = gltf.model.nodes[placed.node];
    if (!draws_a_mesh(node, placed)) continue;
    const auto mesh = static_cast<std::size_t>(node.mesh);
    if (counted[mesh]) continue;
    counted[mesh] = 1;
    for (std::size_t p = 0; p < gltf.model.meshes[mesh].primitives.size(); ++p) add_size(gltf, mesh, p, total);
  }
}

}  // namespace

void import_gltf(const std::filesystem::path& path, Scene& scene, Warnings& warnings) {
  Gltf gltf = read_gltf(path, warnings);
  scene.sources.push_back(path.filename().string());
  Materials materials(gltf, scene, warnings);
  std::vector<std::uint32_t> mesh_numbers(gltf.model.meshes.size(), kNone);
  const std::vector<PlacedNode> nodes = place_nodes(gltf);
  check_size(gltf, nodes);
  for (const PlacedNode& placed : nodes) {
    const tinygltf::Node& node = gltf.model.nodes[placed.node];
    const std::string here = place(gltf.json, "nodes", placed.node);
    add_light(gltf, placed, scene, warnings);
    add_camera(gltf, placed, scene, warnings);
    if (node.mesh < 0) continue;
    if (node.skin >= 0)
      warnings.add(gltf.file, here, "a skin is ignored: the mesh is baked unposed, where its node is");
    if (!draws_a_mesh(node, placed)) {
      warnings.add(gltf.file, here, "a mesh whose scale is zero or not within 1e-9 to 1e9 is skipped");
      continue;
    }
    std::uint32_t& mesh = mesh_numbers[static_cast<std::size_t>(node.mesh)];
    if (mesh == kNone) mesh = add_mesh(gltf, static_cast<std::size_t>(node.mesh), materials, scene, warnings);
    scene.instances.push_back({node.name, gltf.file + ": " + here, placed.world_from_local, mesh});
  }
  materials.warn();
  scene.files_read.insert(scene.files_read.end(), gltf.files_read.begin(), gltf.files_read.end());
}

}  // namespace chandelier::baker
