// SPDX-License-Identifier: Apache-2.0
// Checks the JSON of a glTF before anything trusts it: types, ranges, references, node tree.
#include "gltf_check.h"

#include <algorithm>
#include <cmath>

namespace chandelier::baker {
namespace {

void check_buffer(const Json&, const Object& buffer) {
  buffer.integer("byteLength", 0, largest_byte_count, Need::required);
  buffer.text("uri");
  for (const char* name : {"EXT_meshopt_compression", "KHR_meshopt_compression"}) {
    if (const auto extension = buffer.extension(name)) extension->boolean("fallback");
  }
}

void check_buffer_view(const Json& root, const Object& view) {
  view.index("buffer", section_size(root, "buffers"), Need::required);
  view.integer("byteOffset", 0, largest_byte_count);
  view.integer("byteLength", 0, largest_byte_count, Need::required);
  view.integer("byteStride", 4, 252);
  const Json* stride = view.find("byteStride");
  if (stride && stride->get<uint64_t>() % 4 != 0) view.bad("byteStride", "is not a multiple of 4", *stride);
  check_meshopt_view(root, view);
}

void check_component_type(const Object& object) {
  object.integer("componentType", 5120, 5126, Need::required);
  if (object.json["componentType"] == 5124) object.bad("componentType", "is not a glTF type", 5124);
}

void check_accessor(const Json& root, const Object& accessor) {
  const size_t views = section_size(root, "bufferViews");
  accessor.index("bufferView", views);
  accessor.integer("byteOffset", 0, largest_byte_count);
  check_component_type(accessor);
  accessor.boolean("normalized");
  accessor.integer("count", 0, 0xFFFFFFFEu, Need::required);
  accessor.text("type", Need::required);
  const auto sparse = accessor.object("sparse");
  if (!sparse) return;
  sparse->integer("count", 0, largest_int, Need::required);
  const auto indices = sparse->object("indices", Need::required);
  indices->index("bufferView", views, Need::required);
  indices->integer("byteOffset", 0, largest_int);
  check_component_type(*indices);
  const auto values = sparse->object("values", Need::required);
  values->index("bufferView", views, Need::required);
  values->integer("byteOffset", 0, largest_int);
}

void check_weights(const Object& object) {
  const Json* weights = object.find("weights");
  if (!weights) return;
  if (!weights->is_array()) object.bad("weights", "is not an array", *weights);
  for (const Json& weight : *weights) object.check_number("weights", weight, -largest_number, largest_number);
}

void check_mesh(const Json& root, const Object& mesh) {
  const size_t accessors = section_size(root, "accessors");
  check_weights(mesh);
  for (const Object& primitive : mesh.objects("primitives", Need::required)) {
    primitive.integer("mode", 0, 6);
    primitive.index("material", section_size(root, "materials"));
    primitive.index("indices", accessors);
    const auto attributes = primitive.object("attributes", Need::required);
    for (const auto& [name, value] : attributes->json.items()) {
      primitive.check_index(("attribute " + name).c_str(), value, accessors);
    }
    for (const Object& target : primitive.objects("targets")) {
      for (const auto& [name, value] : target.json.items()) target.check_index(name.c_str(), value, accessors);
    }
    check_draco(root, primitive);
  }
}

/// A matrix, by columns, is affine: in the world, w stays 1.
void check_last_row(const Object& node) {
  const Json* matrix = node.find("matrix");
  if (!matrix) return;
  const Json row = {(*matrix)[3], (*matrix)[7], (*matrix)[11], (*matrix)[15]};
  for (size_t i = 0; i < 4; ++i) {
    if (std::abs(row[i].get<double>() - (i == 3)) > 1e-6) node.bad("matrix", "its last row is not 0, 0, 0, 1", row);
  }
}

void check_node(const Json& root, const Object& node) {
  node.index("mesh", section_size(root, "meshes"));
  node.index("camera", section_size(root, "cameras"));
  node.index("skin", section_size(root, "skins"));
  node.indices("children", section_size(root, "nodes"));
  node.numbers("matrix", 16, -largest_number, largest_number);
  check_last_row(node);
  check_weights(node);
  node.numbers("translation", 3, -largest_number, largest_number);
  node.numbers("rotation", 4, -largest_number, largest_number);
  node.numbers("scale", 3, -largest_number, largest_number);
  check_instancing(root, node);
  if (const auto visibility = node.extension("KHR_node_visibility")) visibility->boolean("visible");
  const auto light = node.extension("KHR_lights_punctual");
  if (!light) return;
  const auto extensions = root.find("extensions");
  const Json empty = Json::object();
  const Json& lights =
      extensions != root.end() && extensions->is_object() && extensions->contains("KHR_lights_punctual")
          ? (*extensions)["KHR_lights_punctual"]
          : empty;
  light->index("light", lights.is_object() ? section_size(lights, "lights") : 0, Need::required);
}

void check_texture_use(const Json& root, const Object& owner, const char* key, const char* strength) {
  const auto use = owner.object(key);
  if (!use) return;
  use->index("index", section_size(root, "textures"), Need::required);
  use->integer("texCoord", 0, largest_int);
  if (strength) use->number(strength, -largest_number, largest_number);
  check_texture_transform(*use);
}

void check_material(const Json& root, const Object& material) {
  if (const auto pbr = material.object("pbrMetallicRoughness")) {
    pbr->numbers("baseColorFactor", 4, 0, 1);
    pbr->number("metallicFactor", 0, 1);
    pbr->number("roughnessFactor", 0, 1);
    check_texture_use(root, *pbr, "baseColorTexture", nullptr);
    check_texture_use(root, *pbr, "metallicRoughnessTexture", nullptr);
  }
  check_texture_use(root, material, "normalTexture", "scale");
  check_texture_use(root, material, "occlusionTexture", "strength");
  check_texture_use(root, material, "emissiveTexture", nullptr);
  material.numbers("emissiveFactor", 3, 0, largest_number);
  material.text("alphaMode");
  material.number("alphaCutoff", 0, largest_number);
  material.boolean("doubleSided");
  if (const auto strength = material.extension("KHR_materials_emissive_strength")) {
    strength->number("emissiveStrength", 0, largest_number);
  }
  if (const auto transmission = material.extension("KHR_materials_transmission")) {
    transmission->number("transmissionFactor", 0, 1);
    check_texture_use(root, *transmission, "transmissionTexture", nullptr);
  }
  if (const auto glossy = material.extension("KHR_materials_pbrSpecularGlossiness")) {
    glossy->numbers("diffuseFactor", 4, 0, 1);
    glossy->numbers("specularFactor", 3, 0, 1);
    glossy->number("glossinessFactor", 0, 1);
    check_texture_use(root, *glossy, "diffuseTexture", nullptr);
    check_texture_use(root, *glossy, "specularGlossinessTexture", nullptr);
  }
}

void check_texture(const Json& root, const Object& texture) {
  texture.index("source", section_size(root, "images"));
  texture.index("sampler", section_size(root, "samplers"));
  check_texture_sources(root, texture);
}

void check_sampler(const Json&, const Object& sampler) {
  for (const char* key : {"magFilter", "minFilter", "wrapS", "wrapT"}) sampler.integer(key, 0, 65535);
}

void check_image(const Json& root, const Object& image) {
  image.text("uri");
  image.text("mimeType");
  image.index("bufferView", section_size(root, "bufferViews"));
}

void check_camera(const Json&, const Object& camera) {
  camera.text("type", Need::required);
  const Json& type = camera.json["type"];
  if (type == "orthographic") {
    const auto orthographic = camera.object("orthographic", Need::required);
    for (const char* key : {"xmag", "ymag", "znear", "zfar"})
      orthographic->number(key, -largest_number, largest_number, Need::required);
    return;
  }
  if (type != "perspective") camera.bad("type", "is not a camera type", type);
  const auto perspective = camera.object("perspective", Need::required);
  perspective->number("yfov", -largest_number, largest_number, Need::required);
  perspective->number("znear", 0, largest_number, Need::required);
  perspective->number("zfar", 0, largest_number);
  perspective->number("aspectRatio", 1e-6, 1e6);
}

void check_light(const Json&, const Object& light) {
  light.text("type", Need::required);
  light.text("name");
  light.numbers("color", 3, 0, 1e6);   // glTF says up to 1; a pack holds this much
  light.number("intensity", 0, 1e12);  // a pack's limit
  light.number("range", 0, largest_number);
  const double range = light.json.value("range", 0.0);  // 0, which glTF does not allow, is taken as none
  if (range > 0 && range < 1e-12) light.bad("range", "is out of range", light.json["range"]);
  const Json& type = light.json["type"];
  if (type != "point" && type != "spot" && type != "directional") light.bad("type", "is not a light type", type);
  if (type != "spot") return;
  const auto spot = light.object("spot", Need::required);
  constexpr double half_pi = 1.5708;
  spot->number("innerConeAngle", 0, half_pi);
  spot->number("outerConeAngle", 1e-6, half_pi);
  if (spot->json.value("innerConeAngle", 0.0) > spot->json.value("outerConeAngle", 0.7853981633974483)) {
    spot->bad("innerConeAngle", "is wider than the outer cone", spot->json["innerConeAngle"]);
  }
}

void check_scene(const Json& root, const Object& scene) {
  scene.indices("nodes", section_size(root, "nodes"));
}

/// Each entry of a section is an object and passes `check`.
void check_section(const Json& root, const Json& owner, const char* section, const std::string& file,
                   void (*check)(const Json&, const Object&)) {
  const auto it = owner.find(section);
  if (it == owner.end()) return;
  if (!it->is_array()) fail(file + ": " + section, "is not an array (" + shown(*it) + ")");
  for (size_t i = 0; i < it->size(); ++i) {
    if (!(*it)[i].is_object())
      fail(file + ": " + place(owner, section, i), "is not an object (" + shown((*it)[i]) + ")");
    const Object object{(*it)[i], file + ": " + place(owner, section, i)};
    object.text("name");
    check(root, object);
  }
}

/// glTF nodes are strict trees: at most one parent each, no cycle; scenes name roots only.
void check_tree(const Json& json, const std::string& file) {
  const size_t count = section_size(json, "nodes");
  std::vector<size_t> parent(count, count);
  for (size_t i = 0; i < count; ++i) {
    const auto children = json["nodes"][i].find("children");
    if (children == json["nodes"][i].end()) continue;
    for (const Json& child : *children) {
      const auto c = child.get<size_t>();
      if (parent[c] != count) {
        fail(file + ": " + place(json, "nodes", c),
             "has two parents (" + std::to_string(parent[c]) + " and " + std::to_string(i) + ")");
      }
      parent[c] = i;
    }
  }
  std::vector<uint8_t> clear(count, 0);  // whether its path to a root is known to end
  for (size_t i = 0; i < count; ++i) {
    std::vector<size_t> way;
    size_t at = i;
    for (; at != count && !clear[at]; at = parent[at]) {
      way.push_back(at);
      if (way.size() > count) fail(file + ": " + place(json, "nodes", i), "is its own ancestor (a cycle of nodes)");
    }
    for (size_t each : way) clear[each] = 1;
  }
  for (size_t i = 0; i < section_size(json, "scenes"); ++i) {
    const auto nodes = json["scenes"][i].find("nodes");
    if (nodes == json["scenes"][i].end()) continue;
    for (const Json& node : *nodes) {
      if (parent[node.get<size_t>()] == count) continue;
      fail(file + ": " + place(json, "scenes", i) + ", nodes",
           "names a node that is below another (" + shown(node) + ")");
    }
  }
}

}  // namespace

std::string place(const Json& json, const char* section, size_t index) {
  static const std::pair<const char*, const char*> singular_names[] = {{"meshes", "mesh"},
                                                                       {"bufferViews", "buffer view"}};
  std::string out = std::string(section).substr(0, std::string(section).size() - 1);
  for (const auto& [plural, singular] : singular_names) {
    if (std::string(section) == plural) out = singular;
  }
  out += " " + std::to_string(index);
  const auto all = json.find(section);
  if (all == json.end() || !all->is_array() || index >= all->size() || !(*all)[index].is_object()) return out;
  const auto name = (*all)[index].find("name");
  if (name == (*all)[index].end() || !name->is_string() || name->get_ref<const std::string&>().empty()) return out;
  return out + " '" + shortened(name->get_ref<const std::string&>(), 80) + "'";
}

bool is_accessor_type(const std::string& type) {
  static const char* const types[] = {"SCALAR", "VEC2", "VEC3", "VEC4", "MAT2", "MAT3", "MAT4"};
  return std::find(std::begin(types), std::end(types), type) != std::end(types);
}

void check_gltf(const Json& json, const std::string& file) {
  if (!json.is_object()) fail(file, "is not a glTF: the JSON is not an object");
  const Object root{json, file + ": glTF"};
  const auto asset = root.object("asset", Need::required);
  asset->text("version", Need::required);
  const std::string version = asset->json["version"].get<std::string>();
  if (version.rfind("2.", 0) != 0) asset->bad("version", "is not 2.x", asset->json["version"]);
  asset->text("minVersion");
  const std::string least = asset->json.value("minVersion", "2.0");
  if (least.rfind("2.", 0) != 0) asset->bad("minVersion", "is not 2.x", least);
  check_section(json, json, "buffers", file, check_buffer);
  check_section(json, json, "bufferViews", file, check_buffer_view);
  check_section(json, json, "accessors", file, check_accessor);
  check_section(json, json, "images", file, check_image);
  check_section(json, json, "samplers", file, check_sampler);
  check_section(json, json, "textures", file, check_texture);
  check_section(json, json, "materials", file, check_material);
  check_section(json, json, "meshes", file, check_mesh);
  check_section(json, json, "cameras", file, check_camera);
  if (const auto lights = root.extension("KHR_lights_punctual")) {
    check_section(json, lights->json, "lights", file, check_light);
  }
  check_section(json, json, "nodes", file, check_node);
  check_section(json, json, "scenes", file, check_scene);
  check_section(json, json, "animations", file, check_animation);
  check_section(json, json, "skins", file, check_skin);
  root.index("scene", section_size(json, "scenes"));
  check_tree(json, file);
}

}  // namespace chandelier::baker
