// SPDX-License-Identifier: Apache-2.0
// Small scenes made in code, as packs, for tests that draw.
#include "scene_builder.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "../unit/pack_sample.h"
#include "octahedral.h"
#include "pack_checks.h"

namespace chandelier::test {
namespace {

constexpr size_t batch_indices = 3 * 128;

glm::vec3 transform(const glm::mat4& m, const glm::vec3& p) {
  return glm::vec3(m * glm::vec4(p, 1.0f));
}

// A box that starts empty.
struct Box {
  glm::vec3 min{std::numeric_limits<float>::infinity()};
  glm::vec3 max{-std::numeric_limits<float>::infinity()};
  void include(const glm::vec3& p) {
    min = glm::min(min, p);
    max = glm::max(max, p);
  }
};

pack::Light light_of(pack::LightType type, const glm::vec3& position_ws, const glm::vec3& direction, float intensity,
                     float range_m) {
  pack::Light light;
  light.type = type;
  light.position_ws = position_ws;
  light.direction_ws = glm::normalize(direction);
  light.intensity = intensity;
  light.range_m = light.nearest_caster_m = range_m;
  light.color = glm::vec3(1.0f);
  light.inner_cone_cos = 1.0f;
  light.outer_cone_cos = -1.0f;
  return light;
}

}  // namespace

Mesh quad(const glm::vec3& center, const glm::vec3& half_u, const glm::vec3& half_v) {
  const glm::vec3 n = glm::normalize(glm::cross(half_u, half_v));
  return {{{center - half_u - half_v, n, {0, 1}},
           {center + half_u - half_v, n, {1, 1}},
           {center + half_u + half_v, n, {1, 0}},
           {center - half_u + half_v, n, {0, 0}}},
          {0, 1, 2, 0, 2, 3}};
}

Mesh level_square(const glm::vec3& center, float half_m) {
  return quad(center, {half_m, 0, 0}, {0, 0, -half_m});
}

Mesh box(const glm::vec3& min, const glm::vec3& max) {
  const glm::vec3 center = 0.5f * (min + max);
  const glm::vec3 half = 0.5f * (max - min);
  Mesh mesh;
  for (int axis = 0; axis < 3; ++axis) {
    for (const float side : {1.0f, -1.0f}) {
      glm::vec3 out(0.0f), u(0.0f), v(0.0f);
      out[axis] = side * half[axis];
      u[(axis + 1) % 3] = side * half[(axis + 1) % 3];
      v[(axis + 2) % 3] = half[(axis + 2) % 3];
      const Mesh face = quad(center + out, u, v);
      const auto first = static_cast<uint32_t>(mesh.vertices.size());
      mesh.vertices.insert(mesh.vertices.end(), face.vertices.begin(), face.vertices.end());
      for (uint32_t index : face.indices) mesh.indices.push_back(first + index);
    }
  }
  return mesh;
}

Mesh sphere(const glm::vec3& center, float radius_m, uint32_t segments) {
  Mesh mesh;
  const uint32_t rings = segments / 2;
  const float pi = std::acos(-1.0f);
  for (uint32_t ring = 0; ring <= rings; ++ring) {
    for (uint32_t i = 0; i <= segments; ++i) {
      const float v = static_cast<float>(ring) / static_cast<float>(rings);
      const float u = static_cast<float>(i) / static_cast<float>(segments);
      const glm::vec3 n(std::sin(pi * v) * std::cos(2 * pi * u), std::cos(pi * v),
                        -std::sin(pi * v) * std::sin(2 * pi * u));
      mesh.vertices.push_back({center + radius_m * n, n, {u, v}});
    }
  }
  for (uint32_t ring = 0; ring < rings; ++ring) {
    for (uint32_t i = 0; i < segments; ++i) {
      const uint32_t a = ring * (segments + 1) + i;
      const uint32_t b = a + segments + 1;
      if (ring > 0) mesh.indices.insert(mesh.indices.end(), {a, b, a + 1});
      if (ring + 1 < rings) mesh.indices.insert(mesh.indices.end(), {a + 1, b, b + 1});
    }
  }
  return mesh;
}

pack::Material plain_material(const glm::vec3& base_color, float metallic, float roughness) {
  pack::Material material;
  material.base_color_factor = glm::vec4(base_color, 1.0f);
  material.metallic_factor = metallic;
  material.roughness_factor = roughness;
  material.alpha_cutoff = 0.5f;
  material.normal_scale = 1.0f;
  material.base_color_texture = material.metallic_roughness_texture = material.normal_texture = pack::none;
  material.occlusion_texture = material.emissive_texture = pack::none;
  return material;
}

pack::Light point_light(const glm::vec3& position_ws, float intensity_cd, float range_m) {
  return light_of(pack::LightType::point, position_ws, {0, -1, 0}, intensity_cd, range_m);
}

pack::Light spot_light(const glm::vec3& position_ws, const glm::vec3& direction, float intensity_cd, float range_m,
                       float inner_rad, float outer_rad) {
  pack::Light light = light_of(pack::LightType::spot, position_ws, direction, intensity_cd, range_m);
  light.inner_cone_cos = std::cos(inner_rad);
  light.outer_cone_cos = std::cos(outer_rad);
  return light;
}

pack::Light directional_light(const glm::vec3& direction, float illuminance_lx) {
  pack::Light light = light_of(pack::LightType::directional, glm::vec3(0.0f), direction, illuminance_lx, 0.0f);
  light.range_source = pack::RangeSource::unbounded;
  return light;
}

uint32_t Scene::add_material(const pack::Material& material) {
  contents_.materials.push_back(material);
  return static_cast<uint32_t>(contents_.materials.size() - 1);
}

uint32_t Scene::add_texture(pack::Image image, std::span<const std::byte> bytes, const UvTransform& uv_transform) {
  contents_.image_data.resize((contents_.image_data.size() + 15) / 16 * 16);
  image.first_byte = contents_.image_data.size();
  image.size_bytes = image.stored_bytes = bytes.size();
  contents_.images.push_back(image);
  contents_.image_data.insert(contents_.image_data.end(), bytes.begin(), bytes.end());
  contents_.textures.push_back({uv_transform, static_cast<uint32_t>(contents_.images.size() - 1),
                                pack::Wrap::clamp_to_edge, pack::Wrap::clamp_to_edge, pack::Filter::nearest,
                                pack::Filter::nearest});
  return static_cast<uint32_t>(contents_.textures.size() - 1);
}

uint32_t Scene::add_texture(uint32_t width, uint32_t height, const std::vector<uint32_t>& texels,
                            const UvTransform& uv_transform) {
  const pack::Image image{.width = width, .height = height, .level_count = 1, .format = pack::ImageFormat::rgba8_unorm};
  return add_texture(image, std::as_bytes(std::span(texels)), uv_transform);
}

void Scene::add_batch(const Mesh& mesh, size_t first, size_t end, uint32_t material, const glm::mat4& world_from_local,
                      uint32_t instance) {
  const auto first_vertex = static_cast<uint32_t>(contents_.positions.size() - mesh.vertices.size());
  const bool mirrored = glm::determinant(glm::mat3(world_from_local)) < 0.0f;
  Box local, world;
  const auto first_index = static_cast<uint32_t>(contents_.indices.size());
  for (size_t i = first; i < end; ++i) {
    const size_t corner = mirrored && i % 3 != 0 ? i + (i % 3 == 1 ? 1 : -1) : i;
    const uint32_t vertex = mesh.indices[corner];
    contents_.indices.push_back({first_vertex + vertex});
    local.include(mesh.vertices[vertex].position);
    world.include(transform(world_from_local, mesh.vertices[vertex].position));
  }
  contents_.batches.push_back({.bounds_min_ls = local.min,
                               .first_index = first_index,
                               .bounds_max_ls = local.max,
                               .index_count = static_cast<uint32_t>(end - first),
                               .cone_cutoff = 1,
                               .material = material});
  contents_.meshes.back().batch_count += 1;
  contents_.batch_instances.push_back(
      {world.min, static_cast<uint32_t>(contents_.batches.size() - 1), world.max, instance});
}

void Scene::filter_textures() {
  for (pack::Texture& texture : contents_.textures) texture.mag_filter = texture.min_filter = pack::Filter::linear;
}

void Scene::add(const Mesh& mesh, uint32_t material, const glm::mat4& world_from_local) {
  for (const Vertex& vertex : mesh.vertices) {
    const glm::vec3 axis = std::abs(vertex.normal.y) < 0.9f ? glm::vec3(0, 1, 0) : glm::vec3(1, 0, 0);
    contents_.positions.push_back({vertex.position});
    contents_.vertex_attributes.push_back(
        {.normal_ls = pack::encode_normal(vertex.normal),
         .tangent_ls = pack::encode_tangent(glm::vec4(glm::normalize(glm::cross(axis, vertex.normal)), 1)),
         .uv0 = vertex.uv,
         .uv1 = vertex.uv,
         .color = 0xFFFFFFFFu});
  }
  const glm::mat4 rows = glm::transpose(world_from_local);
  contents_.meshes.push_back({.first_batch = static_cast<uint32_t>(contents_.batches.size())});
  contents_.instances.push_back(
      {.world_from_local = {rows[0], rows[1], rows[2]}, .mesh = static_cast<uint32_t>(contents_.meshes.size() - 1)});
  const auto instance = static_cast<uint32_t>(contents_.instances.size() - 1);
  for (size_t first = 0; first < mesh.indices.size(); first += batch_indices)
    add_batch(mesh, first, std::min(first + batch_indices, mesh.indices.size()), material, world_from_local, instance);
}

pack::Contents Scene::contents() const {
  pack::Contents contents = contents_;
  contents.lights = lights;
  for (pack::Light& light : contents.lights) {  // also around a spot light's cone
    light.bounds_center_ws = light.position_ws;
    light.bounds_radius_m = light.range_m;
  }
  const auto order = [&](const pack::BatchInstance& candidate) {
    const uint32_t material = contents.batches[candidate.batch].material;
    return std::pair(contents.materials[material].alpha_mode == pack::AlphaMode::mask, material);
  };
  std::stable_sort(contents.batch_instances.begin(), contents.batch_instances.end(),
                   [&](const auto& a, const auto& b) { return order(a) < order(b); });
  Box bounds;
  for (const pack::BatchInstance& placed : contents.batch_instances) {
    bounds.include(placed.bounds_min_ws);
    bounds.include(placed.bounds_max_ws);
  }
  if (!contents.batch_instances.empty()) {
    contents.bake_info.bounds_min_ws = bounds.min;
    contents.bake_info.bounds_max_ws = bounds.max;
  }
  contents.bake_info.unique_triangles = contents.bake_info.instanced_triangles = contents.indices.size() / 3;
  contents.bake_info.batch_triangles = batch_indices / 3;
  return contents;
}

pack::File Scene::open(pack::Compression compression) const {
  const pack::test::Folder folder;
  pack::write(folder / "scene.chandelier", contents(), compression);
  return pack::File(folder / "scene.chandelier");
}

std::vector<std::array<glm::vec3, 3>> world_triangles(const pack::View& pack) {
  std::vector<std::array<glm::vec3, 3>> triangles;
  for (const pack::BatchInstance& placed : pack.batch_instances) {
    const auto& rows = pack.instances[placed.instance].world_from_local;
    const pack::Batch& batch = pack.batches[placed.batch];
    for (uint32_t i = batch.first_index; i < batch.first_index + batch.index_count; i += 3) {
      std::array<glm::vec3, 3> triangle;
      for (uint32_t corner = 0; corner < 3; ++corner) {
        const glm::vec4 p(pack.positions[pack.indices[i + corner].vertex].position_ls, 1.0f);
        triangle[corner] = {glm::dot(rows[0], p), glm::dot(rows[1], p), glm::dot(rows[2], p)};
      }
      triangles.push_back(triangle);
    }
  }
  return triangles;
}

}  // namespace chandelier::test
