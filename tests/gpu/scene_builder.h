// SPDX-License-Identifier: Apache-2.0
// Small scenes made in code, as packs, for tests that draw.
#pragma once

#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "pack_file.h"

namespace chandelier::test {

struct Vertex {
  glm::vec3 position;
  glm::vec3 normal;
  glm::vec2 uv;
};
/// Triangles, counter-clockwise seen from their front.
struct Mesh {
  std::vector<Vertex> vertices;
  std::vector<uint32_t> indices;
};
/// Its front looks along cross(half_u, half_v); uv is (0, 0) at center - half_u + half_v and (1, 1) opposite.
Mesh quad(const glm::vec3& center, const glm::vec3& half_u, const glm::vec3& half_v);
/// A level square whose front looks up.
Mesh level_square(const glm::vec3& center, float half_m);
Mesh box(const glm::vec3& min, const glm::vec3& max);
Mesh sphere(const glm::vec3& center, float radius_m, uint32_t segments);

pack::Material plain_material(const glm::vec3& base_color, float metallic = 0.0f, float roughness = 1.0f);
pack::Light point_light(const glm::vec3& position_ws, float intensity_cd, float range_m);
pack::Light spot_light(const glm::vec3& position_ws, const glm::vec3& direction, float intensity_cd, float range_m,
                       float inner_rad, float outer_rad);
pack::Light directional_light(const glm::vec3& direction, float illuminance_lx);

/// Rows of a texture's matrix from the mesh's uv to the image's.
using UvTransform = std::array<glm::vec3, 2>;
constexpr UvTransform uv_identity = {glm::vec3(1, 0, 0), glm::vec3(0, 1, 0)};

class Scene {
 public:
  std::vector<pack::Light> lights;

  uint32_t add_material(const pack::Material& material);
  /// One level of linear RGBA8, sampled at the nearest texel. Returns the texture's number.
  uint32_t add_texture(uint32_t width, uint32_t height, const std::vector<uint32_t>& texels,
                       const UvTransform& uv_transform = uv_identity);
  /// Size, levels and format as `image` says; sampled at the nearest texel.
  uint32_t add_texture(pack::Image image, std::span<const std::byte> bytes,
                       const UvTransform& uv_transform = uv_identity);
  /// All textures are filtered linearly, between levels too.
  void filter_textures();
  /// Adds a mesh, in batches of up to 128 triangles, placed by a matrix that may mirror.
  void add(const Mesh& mesh, uint32_t material, const glm::mat4& world_from_local = glm::mat4(1.0f));
  /// What was added last casts no shadow.
  void take_shadow() { contents_.instances.back().shadowless = 1; }
  /// As a pack's.
  pack::Contents contents() const;
  /// Written to a file, which is gone when this returns, and opened.
  pack::File open(pack::Compression compression = pack::Compression::off) const;

 private:
  void add_batch(const Mesh& mesh, size_t first, size_t end, uint32_t material, const glm::mat4& world_from_local,
                 uint32_t instance);
  pack::Contents contents_;
};

/// Every triangle of a pack in the world, in the order of its batch instances.
std::vector<std::array<glm::vec3, 3>> world_triangles(const pack::View& pack);

}  // namespace chandelier::test
