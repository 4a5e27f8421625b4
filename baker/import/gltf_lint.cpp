// SPDX-License-Identifier: Apache-2.0
// Buffers, accessors, cameras, images, nodes, animations and skins; declared extensions and empty arrays anywhere.
#include "gltf_lint.h"

#include <cmath>
#include <set>

namespace chandelier::baker {
namespace {

template <typename Visit>
void for_each(const Lint& lint, const char* section, Visit visit) {
  for (size_t i = 0; i < section_size(lint.json, section); ++i) visit(lint.entry(section, i), i);
}

bool is_one_of(const std::string& text, std::initializer_list<const char*> all) {
  for (const char* each : all) {
    if (text == each) return true;
  }
  return false;
}

std::string text_or(const Json& object, const char* key, const char* otherwise) {
  const auto it = object.find(key);
  return it != object.end() && it->is_string() ? it->get<std::string>() : otherwise;
}

/// A number under a key, or another where there is none.
double number_or(const Json& object, const char* key, double otherwise) {
  const auto it = object.find(key);
  return it != object.end() && it->is_number() ? it->get<double>() : otherwise;
}

void lint_buffers(const Lint& lint) {
  for_each(lint, "buffers", [&](const Json& buffer, size_t i) {
    if (whole(buffer, "byteLength", 1) == 0) lint.warn("buffers", i, "it is empty");
    const std::string uri = text_or(buffer, "uri", "");
    const bool known =
        uri.rfind("data:application/octet-stream", 0) == 0 || uri.rfind("data:application/gltf-buffer", 0) == 0;
    if (uri.rfind("data:", 0) == 0 && !known)
      lint.warn("buffers", i, "the media type of its data URI is not that of a buffer");
  });
  for_each(lint, "bufferViews", [&](const Json& view, size_t i) {
    const uint64_t length = whole(view, "byteLength", 0), offset = whole(view, "byteOffset", 0);
    const uint64_t all = whole(lint.entry("buffers", whole(view, "buffer", 0)), "byteLength", 0);
    if (length == 0) lint.warn("bufferViews", i, "it is empty");
    if (offset + length > all) lint.warn("bufferViews", i, "it ends past its buffer");
    if (!view.contains("byteStride")) return;
    if (whole(view, "byteStride", 0) > length)
      lint.warn("bufferViews", i, "its byteStride is larger than its byteLength");
    if (whole(view, "target", 34962) != 34962)
      lint.warn("bufferViews", i, "it has a byteStride, but its target is not vertices");
  });
}

void lint_accessors(const Lint& lint) {
  for_each(lint, "accessors", [&](const Json& accessor, size_t i) {
    const uint64_t type = whole(accessor, "componentType", 0), element = element_bytes(accessor);
    const uint64_t component = type >= 5125 ? 4 : type >= 5122 ? 2 : 1;
    const uint64_t count = whole(accessor, "count", 0), offset = whole(accessor, "byteOffset", 0);
    if (element == 0) lint.warn("accessors", i, "its type is unknown");
    if (type >= 5125 && accessor.value("normalized", false))
      lint.warn("accessors", i, "it is normalized, but not of 8- or 16-bit integers");
    if (accessor.contains("byteOffset") && !accessor.contains("bufferView"))
      lint.warn("accessors", i, "it has a byteOffset without a buffer view");
    if (accessor.contains("sparse") && whole(accessor["sparse"], "count", 0) > count)
      lint.warn("accessors", i, "it has more sparse elements than elements");
    for (const char* part : {"indices", "values"}) {
      if (accessor.contains("sparse") && lint.view_of(accessor["sparse"][part]).contains("byteStride"))
        lint.warn("accessors", i, "its sparse elements have a byteStride");
    }
    if (!accessor.contains("bufferView") || count == 0) return;
    const Json& view = lint.view_of(accessor);
    const uint64_t stride = whole(view, "byteStride", element), bytes = whole(view, "byteLength", 0);
    if (offset % component != 0 || (offset + whole(view, "byteOffset", 0)) % component != 0)
      lint.warn("accessors", i, "its values are not aligned");
    if (stride < element) lint.warn("accessors", i, "its elements overlap");
    const bool fits =
        offset + element <= bytes && (count - 1) <= (bytes - offset - element) / std::max(stride, uint64_t{1});
    if (!fits) lint.warn("accessors", i, "it ends past its buffer view");
  });
}

void lint_cameras(const Lint& lint) {
  for_each(lint, "cameras", [&](const Json& camera, size_t i) {
    if (camera.contains("perspective") && camera.contains("orthographic"))
      lint.warn("cameras", i, "it is both perspective and orthographic");
    const Json& lens = camera[text_or(camera, "type", "perspective")];
    if (number_or(lens, "zfar", HUGE_VAL) <= number_or(lens, "znear", 0))
      lint.warn("cameras", i, "its zfar is not above its znear");
    if (number_or(lens, "xmag", 1) == 0 || number_or(lens, "ymag", 1) == 0)
      lint.warn("cameras", i, "its xmag or ymag is 0");
  });
}

void lint_images(const Lint& lint) {
  for_each(lint, "images", [&](const Json& image, size_t i) {
    const bool by_view = image.contains("bufferView");
    if (by_view == image.contains("uri")) lint.warn("images", i, "it does not have exactly one of uri and bufferView");
    if (by_view && !image.contains("mimeType")) lint.warn("images", i, "it has no mimeType");
    if (by_view && lint.entry("bufferViews", whole(image, "bufferView", 0)).contains("byteStride")) {
      lint.warn("images", i, "its buffer view has a byteStride");
    }
    const std::string uri = text_or(image, "uri", "");
    const size_t colon = uri.find_first_of(":/?#");
    if (colon != std::string::npos && uri[colon] == ':' && uri.rfind("data:image/", 0) != 0) {
      lint.warn("images", i, "its URI is neither relative nor image data");
    }
  });
}

void lint_nodes(const Lint& lint) {
  for_each(lint, "nodes", [&](const Json& node, size_t i) {
    const bool parts = node.contains("translation") || node.contains("rotation") || node.contains("scale");
    if (parts && node.contains("matrix"))
      lint.warn("nodes", i, "it has a matrix and also translation, rotation or scale: the matrix is used");
    if (!node.contains("mesh") && (node.contains("skin") || node.contains("weights"))) {
      lint.warn("nodes", i, "it has a skin or weights without a mesh");
    }
    double squares = 0;
    if (!node.contains("rotation")) return;
    for (const Json& each : node["rotation"]) squares += each.get<double>() * each.get<double>();
    if (std::abs(std::sqrt(squares) - 1) > 0.00674)
      lint.warn("nodes", i, "its rotation is not of unit length: it is normalized");
  });
}

void lint_animations(const Lint& lint) {
  for_each(lint, "animations", [&](const Json& animation, size_t i) {
    for (const Json& sampler : animation["samplers"]) {
      const Json& input = lint.entry("accessors", whole(sampler, "input", 0));
      const Json& output = lint.entry("accessors", whole(sampler, "output", 0));
      if (!input.contains("min") || !input.contains("max")) lint.warn("animations", i, "its times have no bounds");
      if (whole(input, "componentType", 0) != 5126 || text_or(input, "type", "") != "SCALAR")
        lint.warn("animations", i, "its times are not floats");
      for (const Json* accessor : {&input, &output}) {
        if (lint.view_of(*accessor).contains("byteStride")) lint.warn("animations", i, "its keys have a byteStride");
      }
    }
  });
}

void lint_materials(const Lint& lint) {
  for_each(lint, "materials", [&](const Json& material, size_t i) {
    if (!material.contains("emissiveFactor")) return;
    for (const Json& each : material["emissiveFactor"]) {
      if (each.get<double>() > 1) lint.warn("materials", i, "its emissiveFactor is above 1: it is used unchanged");
    }
  });
}

/// The parent and the root of each node.
struct Family {
  std::vector<size_t> parent, root;
};

Family family_of(const Lint& lint) {
  const size_t count = section_size(lint.json, "nodes");
  Family out{std::vector<size_t>(count, SIZE_MAX), std::vector<size_t>(count, SIZE_MAX)};
  for_each(lint, "nodes", [&](const Json& node, size_t i) {
    if (!node.contains("children")) return;
    for (const Json& child : node["children"]) out.parent[child.get<size_t>()] = i;
  });
  for (size_t i = 0; i < count; ++i) {
    size_t at = i;
    std::vector<size_t> way;
    for (; out.root[at] == SIZE_MAX && out.parent[at] != SIZE_MAX; at = out.parent[at]) way.push_back(at);
    if (out.root[at] == SIZE_MAX) out.root[at] = at;
    for (const size_t each : way) out.root[each] = out.root[at];
  }
  return out;
}

bool is_above_all(size_t skeleton, const Json& joints, const Family& family) {
  std::set<size_t> below = {skeleton};
  for (const Json& joint : joints) {
    for (auto at = joint.get<size_t>(); !below.contains(at); at = family.parent[at]) {
      if (family.parent[at] == SIZE_MAX) return false;
      below.insert(at);
    }
  }
  return true;
}

void lint_skins(const Lint& lint) {
  if (section_size(lint.json, "skins") == 0) return;
  const Family family = family_of(lint);
  for_each(lint, "skins", [&](const Json& skin, size_t i) {
    const Json& joints = skin["joints"];
    const size_t root = family.root[joints[0].get<size_t>()];
    for (const Json& joint : joints) {
      if (family.root[joint.get<size_t>()] != root) lint.warn("skins", i, "its joints have no common root");
    }
    if (skin.contains("skeleton") && !is_above_all(skin["skeleton"].get<size_t>(), joints, family)) {
      lint.warn("skins", i, "its skeleton is not above its joints");
    }
    if (!skin.contains("inverseBindMatrices")) return;
    const Json& matrices = lint.entry("accessors", whole(skin, "inverseBindMatrices", 0));
    const bool floats = whole(matrices, "componentType", 0) == 5126 && text_or(matrices, "type", "") == "MAT4";
    if (!floats || whole(matrices, "count", 0) < joints.size()) {
      lint.warn("skins", i, "its inverseBindMatrices are not one 4x4 float matrix per joint");
    }
    if (lint.view_of(matrices).contains("byteStride")) lint.warn("skins", i, "its matrices have a byteStride");
  });
}

/// Warns of empty arrays, and of extensions that extensionsUsed does not name; the content of extras and extensions is
/// not checked.
void lint_tree(const Lint& lint, const Json& value, const std::set<std::string>& declared) {
  if (value.is_array() && value.empty()) lint.warnings.add(lint.file, "glTF", "breaks glTF: an array is empty");
  if (!value.is_object() && !value.is_array()) return;
  for (const auto& [key, each] : value.items()) {
    if (value.is_object() && key == "extensions" && each.is_object()) {
      for (const auto& [name, data] : each.items()) {
        if (!declared.contains(name))
          lint.warnings.add(lint.file, "glTF", "breaks glTF: extensionsUsed does not name an extension", name);
      }
    }
    if (!value.is_object() || !is_one_of(key, {"extensions", "extras"})) lint_tree(lint, each, declared);
  }
}

}  // namespace

const Json& Lint::view_of(const Json& accessor) const {
  static const Json no_members = Json::object();
  return accessor.contains("bufferView") ? entry("bufferViews", whole(accessor, "bufferView", 0)) : no_members;
}

uint64_t whole(const Json& object, const char* key, uint64_t otherwise) {
  const auto it = object.find(key);
  return it != object.end() && it->is_number_unsigned() ? it->get<uint64_t>() : otherwise;
}

uint64_t element_bytes(const Json& accessor) {
  const uint64_t type = whole(accessor, "componentType", 0), component = type >= 5125 ? 4 : type >= 5122 ? 2 : 1;
  const std::string shape = text_or(accessor, "type", "");
  if (shape == "SCALAR") return component;
  if (shape.size() != 4) return 0;
  const auto n = static_cast<uint64_t>(shape[3] - '0');
  if (shape[0] == 'V') return n * component;
  return n * ((n * component + 3) / 4 * 4);  // columns start at multiples of four bytes
}

void lint_gltf(const Json& json, const std::string& file, Warnings& warnings) {
  const Lint lint{json, file, warnings};
  lint_buffers(lint);
  lint_accessors(lint);
  lint_meshes(lint);
  lint_cameras(lint);
  lint_images(lint);
  lint_nodes(lint);
  lint_animations(lint);
  lint_skins(lint);
  lint_materials(lint);
  lint_keys(lint);
  std::set<std::string> declared;
  const auto used = json.find("extensionsUsed");
  if (used != json.end()) declared.insert(used->begin(), used->end());
  if (used != json.end() && declared.size() < used->size()) {
    warnings.add(file, "extensionsUsed", "breaks glTF: it names an extension twice");
  }
  if (json["asset"].value("minVersion", "2.0") != "2.0") {
    warnings.add(file, "asset", "asks for a later glTF than 2.0; only 2.0 is read");
  }
  lint_tree(lint, json, declared);
}

}  // namespace chandelier::baker
