// SPDX-License-Identifier: Apache-2.0
// The imported scene: what the bake passes read. Plain structs, no type of any file format.
// Right-handed, +Y up, metres; uv v points down; front faces are counter-clockwise.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <glm/glm.hpp>
#include <optional>
#include <string>
#include <vector>

namespace chandelier::baker {

constexpr uint32_t no_index = 0xFFFFFFFFu;

/// No padding: vertices are compared byte by byte.
struct Vertex {
  glm::vec3 position_ls{0};
  glm::vec3 normal_ls{0, 1, 0};
  glm::vec4 tangent_ls{1, 0, 0, 1};  // w: the bitangent's sign
  glm::vec2 uv0{0};
  glm::vec2 uv1{0};
  uint32_t color = 0xFFFFFFFFu;  // linear RGBA8, R lowest
};
static_assert(sizeof(Vertex) == 60);

/// Joints and weights of a vertex, as the pack has them.
struct SkinVertex {
  std::array<uint16_t, 4> joints{};   // numbers among the skin's joints
  std::array<uint16_t, 4> weights{};  // unorm, their sum 65535
};

struct Primitive {
  std::vector<Vertex> vertices;
  std::vector<SkinVertex> skin_vertices;  // one per vertex, or none
  std::vector<uint32_t> indices;          // a triangle list
  uint32_t material = 0;
  bool needs_normals = false;   // the file has none
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
  uint32_t mesh = 0;
  uint32_t node = no_index;  // of Scene::nodes, where an animation or a skin moves it
  uint32_t skin = no_index;
  bool shadowless = false;
};

enum class Wrap { repeat, clamp_to_edge, mirrored_repeat };
enum class Filter { nearest, linear };

/// A material of KHR_materials_pbrSpecularGlossiness: factors that scale the texels of two images, linear, each of them
/// white where there is no image.
struct SpecularGlossiness {
  glm::vec3 diffuse_factor{1};
  glm::vec3 specular_factor{1};
  float glossiness_factor = 1;
  uint32_t diffuse = no_index;              // of Scene::images: RGB sRGB, and alpha, which stays as it is
  uint32_t specular_glossiness = no_index;  // RGB sRGB, alpha glossiness

  bool operator==(const SpecularGlossiness&) const = default;
};

/// An image as PNG, JPEG or WebP bytes; or one without bytes that is converted from others. Used as a colour, that one
/// is the material's base colour and alpha; used as data, its roughness (G) and metallic (B).
struct EncodedImage {
  std::string name;
  std::string where;  // for messages: file and image
  std::vector<uint8_t> bytes;
  std::string file = {};  // the first part of `where`
  std::optional<SpecularGlossiness> converted_from = {};
  bool damage_reported = false;  // a warning has named the damage; one is enough
};

struct Texture {
  uint32_t image = 0;
  Wrap wrap_u = Wrap::repeat;
  Wrap wrap_v = Wrap::repeat;
  Filter mag_filter = Filter::linear;
  Filter min_filter = Filter::linear;
};

/// Rows of a 2×3 matrix from a mesh's uv to an image's (KHR_texture_transform).
using UvTransform = std::array<glm::vec3, 2>;
constexpr UvTransform uv_identity = {glm::vec3(1, 0, 0), glm::vec3(0, 1, 0)};

struct TextureUse {
  uint32_t texture = no_index;
  bool uv1 = false;
  UvTransform uv_transform = uv_identity;
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
  bool unlit = false;
  std::string where;              // for messages: file and material
  float transmission_factor = 0;  // the part of the light that passes through
  TextureUse transmission_map;    // red multiplies it
  std::optional<bool> shadow;     // whether its author wants a shadow, if the extras say so
  bool shadowless = false;        // casts none
};

enum class LightType { point, spot, directional };

struct Light {
  std::string name;
  LightType type = LightType::point;
  glm::dvec3 position_ws{0};
  glm::vec3 direction_ws{0, 0, -1};
  glm::vec3 color{1};              // linear
  float intensity = 1;             // candela; lux for a directional light
  std::optional<float> range_m;    // as authored
  float inner_cone_rad = 0;        // spot only
  float outer_cone_rad = 0.7854f;  // spot only
  std::string where;               // for messages: file and node
  uint32_t node = no_index;        // of Scene::nodes, where an animation moves it
  std::optional<float> power_w;    // from the author's extras (light_extras.schema.json)
  uint32_t priority = 128;         // 0 to 255
  bool dynamic = false;
  bool unclustered = false;
  bool shadowless = false;
  float radius_m = 0;  // of a directional light: the tangent of half its angle
  std::string group;   // name of the lights that share its shadow map; empty: none
};

struct Camera {
  std::string name;
  glm::dvec3 position_ws{0};
  glm::vec3 forward_ws{0, 0, -1};
  glm::vec3 up_ws{0, 1, 0};
  float yfov_rad = 0.8f;
  float aspect = 0;  // width over height; 0: the picture's own
  float znear_m = 0.1f;
  uint32_t node = no_index;  // of Scene::nodes, where an animation moves it
};

/// A node that moves, or that carries one that moves. Parents come before their children.
struct Node {
  std::string name;
  uint32_t parent = no_index;
  glm::dmat4 parent_from_local{1};
  glm::dvec3 translation{0};
  glm::vec4 rotation{0, 0, 0, 1};  // unit quaternion x, y, z, w
  glm::vec3 scale{1};
};

enum class AnimationPath { translation, rotation, scale };
enum class Interpolation { linear, step, cubic_spline };

struct AnimationChannel {
  uint32_t node = 0;
  AnimationPath path = AnimationPath::translation;
  Interpolation interpolation = Interpolation::linear;
  std::vector<float> times_s;  // ascending
  std::vector<float> values;   // key after key
};

struct Animation {
  std::string name;
  std::vector<AnimationChannel> channels;
};

struct Joint {
  uint32_t node = 0;
  glm::mat4 joint_from_bind{1};
};

struct Skin {
  std::string name;
  std::vector<Joint> joints;
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
  std::vector<Node> nodes;
  std::vector<Animation> animations;
  std::vector<Skin> skins;
  glm::dvec3 origin_m{0};  // where the world's origin lies in the files' coordinates
};

}  // namespace chandelier::baker
