// SPDX-License-Identifier: Apache-2.0
// The imported scene: what the bake passes read. Plain structs, no type of any file format.
// Right-handed, +Y up, metres; uv v points down; front faces are counter-clockwise.
#pragma once

#include <cstdint>
#include <filesystem>
#include <glm/glm.hpp>
#include <optional>
#include <string>
#include <vector>

namespace chandelier::baker {

constexpr std::uint32_t kNone = 0xFFFFFFFFu;

/// No padding: vertices are compared byte by byte.
struct Vertex {
  glm::vec3 position_ls{0};
  glm::vec3 normal_ls{0, 1, 0};
  glm::vec4 tangent_ls{1, 0, 0, 1};  // w: the bitangent's sign
  glm::vec2 uv0{0};
  glm::vec2 uv1{0};
  std::uint32_t color = 0xFFFFFFFFu;  // linear RGBA8, R lowest
};
static_assert(sizeof(Vertex) == 60);

struct Primitive {
  std::vector<Vertex> vertices;
  std::vector<std::uint32_t> indices;  // a triangle list
  std::uint32_t material = 0;
  bool needs_tangents = false;  // a normal map without tangents of its own
  bool tangents_from_uv1 = false;
};

struct Mesh {
  std::vector<Primitive> primitives;
};

struct MeshInstance {
  std::string name;
  std::string where;
  glm::dmat4 world_from_local{1};
  std::uint32_t mesh = 0;
};

enum class Wrap { repeat, clamp_to_edge, mirrored_repeat };
enum class Filter { nearest, linear };

/// An image as its file has it: PNG or JPEG bytes.
struct EncodedImage {
  std::string name;
  std::string where;  // for messages: file and image
  std::vector<std::uint8_t> bytes;
};

struct Texture {
  std::uint32_t image = 0;
  Wrap wrap_u = Wrap::repeat;
  Wrap wrap_v = Wrap::repeat;
  Filter mag_filter = Filter::linear;
  Filter min_filter = Filter::linear;
};

struct TextureUse {
  std::uint32_t texture = kNone;
  bool uv1 = false;
};

struct Material {
  std::string name;
  glm::vec4 base_color_factor{1};
  glm::vec3 emissive{0};
  float metallic_factor = 1;
  float roughness_factor = 1;
  float alpha_cutoff = 0.5f;
  float normal_scale = 1;
  float occlusion_strength = 1;
  TextureUse base_color, metallic_roughness, normal, occlusion, emissive_map;
  bool masked = false;
  bool double_sided = false;
};

enum class LightType { point, spot, directional };

struct Light {
  std::string name;
  LightType type = LightType::point;
  glm::vec3 position_ws{0};
  glm::vec3 direction_ws{0, 0, -1};
  glm::vec3 color{1};              // linear
  float intensity = 1;             // candela; lux for a directional light
  std::optional<float> range_m;    // as authored
  float inner_cone_rad = 0;        // spot only
  float outer_cone_rad = 0.7854f;  // spot only
};

struct Camera {
  std::string name;
  glm::vec3 position_ws{0};
  glm::vec3 forward_ws{0, 0, -1};
  glm::vec3 up_ws{0, 1, 0};
  float yfov_rad = 0.8f;
  float aspect = 0;  // width over height; 0: the picture's own
  float znear_m = 0.1f;
};

struct Scene {
  std::vector<std::string> sources;               // the inputs' file names, without folders
  std::vector<std::filesystem::path> files_read;  // the inputs and every file that they name and use
  std::vector<Mesh> meshes;
  std::vector<MeshInstance> instances;
  std::vector<Material> materials;
  std::vector<Texture> textures;
  std::vector<EncodedImage> images;
  std::vector<Light> lights;
  std::vector<Camera> cameras;
};

}  // namespace chandelier::baker
