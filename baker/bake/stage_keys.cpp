// SPDX-License-Identifier: Apache-2.0
// Each struct is destructured into all its members, so a new member does not compile until it is part of the key, or is
// left out on purpose.
#include "stage_keys.h"

#include <glm/glm.hpp>

namespace chandelier::baker {
namespace {

class SceneKey {
 public:
  explicit SceneKey(CacheKey& key) : key_(key) {}

  template <typename Item>
  void add_all(const std::vector<Item>& items) {
    key_.add(uint64_t{items.size()});
    for (const Item& item : items) add(item);
  }

 private:
  template <glm::length_t N, typename T>
  void add(const glm::vec<N, T>& vector) {
    for (glm::length_t i = 0; i < N; ++i) key_.add(vector[i]);
  }

  template <typename T>
  void add(const glm::mat<4, 4, T>& matrix) {
    for (glm::length_t column = 0; column < 4; ++column) add(matrix[column]);
  }

  void add(const Primitive& primitive) {
    const auto& [vertices, skin_vertices, indices, material, needs_normals, needs_tangents, tangents_from_uv1] =
        primitive;
    static_assert(sizeof(Vertex) == 15 * 4 && sizeof(SkinVertex) == 8 * 2, "no padding");
    key_.add_records(vertices);
    key_.add_records(skin_vertices);
    key_.add_records(indices);
    key_.add(material);
    for (const bool value : {needs_normals, needs_tangents, tangents_from_uv1}) key_.add(value);
  }

  void add(const Mesh& mesh) {
    const auto& [primitives] = mesh;
    add_all(primitives);
  }

  void add(const MeshInstance& instance) {
    const auto& [name, where, world_from_local, mesh, node, skin, shadowless] = instance;
    key_.add_text(name);
    add(world_from_local);
    for (const uint32_t number : {mesh, node, skin}) key_.add(number);
    key_.add(shadowless);
  }

  void add(const TextureUse& use) {
    const auto& [texture, uv1, uv_transform] = use;
    key_.add(texture);
    key_.add(uv1);
    for (const glm::vec3& row : uv_transform) add(row);
  }

  void add(const Material& material) {
    const auto& [name, base_color_factor, emissive, metallic_factor, roughness_factor, alpha_cutoff, normal_scale,
                 occlusion_strength, base_color, metallic_roughness, normal, occlusion, emissive_map, masked,
                 double_sided, unlit, where, transmission_factor, transmission_map, shadow, shadowless] =
        material;  // glass is already found: shadowless holds what its map has decided
    add(base_color_factor);
    add(emissive);
    for (const float value : {metallic_factor, roughness_factor, alpha_cutoff, normal_scale, occlusion_strength}) {
      key_.add(value);
    }
    for (const TextureUse* use : {&base_color, &metallic_roughness, &normal, &occlusion, &emissive_map}) add(*use);
    for (const bool value : {masked, double_sided, unlit, shadowless}) key_.add(value);
  }

  void add(const Node& node) {
    const auto& [name, parent, parent_from_local, translation, rotation, scale] = node;
    key_.add(parent);
    add(parent_from_local);
    add(translation);
    add(rotation);
    add(scale);
  }

  void add(const AnimationChannel& channel) {
    const auto& [node, path, interpolation, times_s, values] = channel;
    key_.add(node);
    key_.add(path);
    key_.add(interpolation);
    key_.add_records(times_s);
    key_.add_records(values);
  }

  void add(const Animation& animation) {
    const auto& [name, channels] = animation;
    add_all(channels);
  }

  void add(const Joint& joint) {
    const auto& [node, joint_from_bind] = joint;
    key_.add(node);
    add(joint_from_bind);
  }

  void add(const Skin& skin) {
    const auto& [name, joints] = skin;
    add_all(joints);
  }

  CacheKey& key_;
};

void add_geometry_settings(CacheKey& key, const BakeSettings& settings) {
  const auto& [batch_triangles, range_threshold_lx, position_error_m, normal_bits, uv_bits, voxels, images,
               smooth_angle_deg, glass_shadows] = settings;
  const auto& [resolution, mode] = voxels;
  key.add(batch_triangles);
  key.add(position_error_m);
  key.add(normal_bits);
  key.add(uv_bits);
  for (const uint32_t cells : resolution) key.add(cells);
  key.add(mode);
  key.add(smooth_angle_deg);
  key.add(images.textures == TextureMode::none);  // then materials have no textures
}

}  // namespace

std::string geometry_entry(const Scene& scene, const BakeSettings& settings) {
  const auto& [sources, files_read, meshes, instances, materials, textures, images, lights, cameras, nodes, animations,
               skins, origin_m] = scene;
  CacheKey key("geometry");
  add_geometry_settings(key, settings);
  SceneKey parts(key);
  parts.add_all(meshes);
  parts.add_all(instances);
  parts.add_all(materials);
  parts.add_all(nodes);
  parts.add_all(animations);
  parts.add_all(skins);
  return key.name();
}

}  // namespace chandelier::baker
