// SPDX-License-Identifier: Apache-2.0
// Reads a .gltf or .glb: container, JSON, extensions, buffers. tinygltf turns the checked JSON into structs; files and
// data URIs are read here, since tinygltf reads past the end of short buffers and loses the place of an error.
#include <cmath>
#include <cstring>
#include <set>

#include "file_kind.h"
#include "gltf_lint.h"
#include "meshopt.h"

namespace chandelier::baker {
namespace {

constexpr int most_nesting = 200;  // of JSON: glTF needs about ten; parsers recurse
constexpr uint32_t glb_magic = 0x46546C67, json_chunk = 0x4E4F534A, bin_chunk = 0x004E4942;

uint32_t u32_at(std::span<const uint8_t> bytes, size_t offset) {
  uint32_t value = 0;
  std::memcpy(&value, bytes.data() + offset, 4);
  return value;
}

struct Chunks {
  std::span<const uint8_t> json, bin;
};

/// If the file is of another known kind, the error says so without parsing it as JSON.
void refuse_other_kinds(std::span<const uint8_t> bytes, const std::string& file) {
  const pack::KnownFile is = pack::known_file(file, std::as_bytes(bytes));
  if (is.kind == pack::FileKind::pack) {
    fail(file, "is not a glTF: it is a Chandelier pack already; chandelier-play shows it, chandelier-inspect lists it");
  }
  if (is.kind != pack::FileKind::other) return;
  fail(file, "is not a glTF: it is " + is.name + (is.advice.empty() ? "" : "; " + is.advice));
}

/// Splits a .glb; a .gltf is all JSON.
Chunks split_container(std::span<const uint8_t> bytes, const std::string& file, Warnings& warnings) {
  if (bytes.size() < 4 || u32_at(bytes, 0) != glb_magic) return {bytes, {}};
  if (bytes.size() < 20) fail(file, "truncated GLB (" + std::to_string(bytes.size()) + " bytes)");
  if (u32_at(bytes, 4) != 2) fail(file, "GLB version is not 2 (" + std::to_string(u32_at(bytes, 4)) + ")");
  const uint64_t length = u32_at(bytes, 8);
  if (length > bytes.size()) {
    fail(file,
         "truncated GLB: header says " + std::to_string(length) + " bytes (" + std::to_string(bytes.size()) + ")");
  }
  Chunks chunks;
  for (uint64_t at = 12, number = 0; at < length; ++number) {
    const std::string where = file + ": GLB chunk " + std::to_string(number);
    if (length - at < 8) fail(where, "truncated (" + std::to_string(length - at) + " bytes left)");
    const uint64_t size = u32_at(bytes, at), type = u32_at(bytes, at + 4);
    if (size > length - at - 8) fail(where, "is longer than the file (" + std::to_string(size) + " bytes)");
    const auto data = bytes.subspan(at + 8, size);
    if (number == 0 && type != json_chunk) fail(where, "is not JSON (type " + std::to_string(type) + ")");
    if (number == 0) chunks.json = data;
    if (number == 1 && type == bin_chunk) chunks.bin = data;
    if (size % 4 != 0) warnings.add(file, where.substr(file.size() + 2), "its length is not a multiple of 4");
    if ((number > 1 && type == bin_chunk) || (number > 0 && type == json_chunk)) {
      warnings.add(file, where.substr(file.size() + 2), "a second or misplaced chunk is ignored");
    }
    at += 8 + size;
  }
  return chunks;
}

void check_nesting(std::span<const uint8_t> text, const std::string& file) {
  int depth = 0;
  bool in_string = false;
  for (size_t i = 0; i < text.size(); ++i) {
    const char c = static_cast<char>(text[i]);
    if (in_string) {
      if (c == '\\') ++i;
      if (c == '"') in_string = false;
      continue;
    }
    if (c == '"') in_string = true;
    if (c == '{' || c == '[') ++depth;
    if (c == '}' || c == ']') --depth;
    if (depth > most_nesting) fail(file, "JSON is nested too deeply (more than " + std::to_string(most_nesting) + ")");
  }
}

Json parse_json(std::span<const uint8_t> text, const std::string& file) {
  check_nesting(text, file);
  try {
    return Json::parse(text.begin(), text.end());
  } catch (const Json::exception& error) {
    std::string what = error.what();  // "[json.exception.parse_error.101] parse error at line 1, ..."
    what = what.substr(what.find(']') == std::string::npos ? 0 : what.find(']') + 2);
    fail(file, "is not a glTF: " + shortened(what, 200));
  }
}

void make_integer(Json& json) {
  if (!json.is_number_float()) return;
  const double number = json.get<double>();
  if (number >= 0 && number < 9e15 && number == std::floor(number)) json = static_cast<uint64_t>(number);
}

/// JSON does not distinguish 1 and 1.0, but tinygltf does. So 1.0 becomes 1 under keys that need whole numbers.
void make_integers(Json& json) {
  static const std::set<std::string> keys = {
      "attributes", "buffer",        "bufferView", "byteLength", "byteOffset", "byteStride", "camera",
      "children",   "componentType", "count",      "index",      "indices",    "input",      "joints",
      "material",   "mesh",          "mode",       "node",       "nodes",      "output",     "sampler",
      "scene",      "skeleton",      "skin",       "source",     "target",     "targets",    "texCoord"};
  if (json.is_array() && !json.empty() && !json[0].is_structured()) return;  // of numbers
  for (auto it = json.begin(); json.is_structured() && it != json.end(); ++it) {
    if (it->is_structured()) make_integers(*it);
    if (!json.is_object() || !keys.contains(it.key())) continue;
    make_integer(*it);
    if (!it->is_structured()) continue;
    for (Json& each : *it) {
      make_integer(each);
      if (it.key() != "targets" || !each.is_object()) continue;
      for (Json& accessor : each) make_integer(accessor);
    }
  }
}

/// Calls `visit(primitive, mesh, number)`.
template <typename JsonOrConst, typename Visit>
void for_each_primitive(JsonOrConst& json, Visit visit) {
  if (!json.contains("meshes")) return;
  for (size_t m = 0; m < json["meshes"].size(); ++m) {
    auto& primitives = json["meshes"][m]["primitives"];
    for (size_t p = 0; p < primitives.size(); ++p) visit(primitives[p], m, p);
  }
}

/// tinygltf refuses accessors of a type that it does not know, used or not: makes them SCALAR and returns them.
std::vector<size_t> hide_unknown_types(Json& json) {
  std::vector<size_t> out;
  for (size_t i = 0; i < section_size(json, "accessors"); ++i) {
    Json& type = json["accessors"][i]["type"];
    if (is_accessor_type(type.get_ref<const std::string&>())) continue;
    type = "SCALAR";
    out.push_back(i);
  }
  return out;
}

/// tinygltf's structs for everything but files and the parts that the baker leaves out. It does not see indices: it
/// refuses those that are all sparse.
tinygltf::Model parse_model(const Json& json, const std::string& file) {
  Json reduced = json;
  for (const char* section : {"buffers", "images", "animations", "skins", "extras"}) reduced.erase(section);
  for_each_primitive(reduced, [](Json& primitive, size_t, size_t) { primitive.erase("indices"); });
  const std::vector<size_t> untyped = hide_unknown_types(reduced);
  const std::string text = reduced.dump();
  if (text.size() > 0xFFFFFFFFu) fail(file, "JSON is too large (" + std::to_string(text.size()) + " bytes)");
  tinygltf::TinyGLTF parser;
  tinygltf::Model model;
  std::string error, warning;
  if (!parser.LoadASCIIFromString(&model, &error, &warning, text.c_str(), static_cast<unsigned>(text.size()), "")) {
    while (!error.empty() && error.back() == '\n') error.pop_back();
    fail(file, "is not a glTF: " + error);
  }
  for (const size_t accessor : untyped) model.accessors[accessor].type = -1;
  for_each_primitive(json, [&](const Json& primitive, size_t mesh, size_t number) {
    model.meshes[mesh].primitives[number].indices = primitive.value("indices", -1);
  });
  return model;
}

/// Whether the buffer has no data of its own: its views are decoded from another one (EXT_meshopt_compression).
bool is_fallback(const Json& buffer) {
  static const Json::json_pointer ext("/extensions/EXT_meshopt_compression/fallback");
  static const Json::json_pointer khr("/extensions/KHR_meshopt_compression/fallback");
  return buffer.value(ext, Json()) == true || buffer.value(khr, Json()) == true;
}

/// A buffer's bytes, or its fault, which is thrown only when something reads it.
void load_buffer(Gltf& gltf, size_t number, std::span<const uint8_t> bin, Warnings& warnings) {
  const Json& json = gltf.json["buffers"][number];
  const std::string here = place(gltf.json, "buffers", number), where = gltf.file + ": " + here;
  const auto length = json["byteLength"].get<uint64_t>();
  Buffer& buffer = gltf.buffers[number];
  if (is_fallback(json)) return;
  if (json.contains("uri")) {
    buffer.data = read_uri(gltf, json["uri"].get<std::string>(), here, warnings);
  } else if (number == 0 && !bin.empty()) {
    buffer.data = {bin, gltf.container.owner};
  } else {
    return;
  }
  if (buffer.data.bytes.size() < length) {
    fail(where, "is shorter than its byteLength " + std::to_string(length) + " (" +
                    std::to_string(buffer.data.bytes.size()) + " bytes)");
  }
  buffer.data.bytes = buffer.data.bytes.first(length);
  buffer.present = true;
}

void load_buffers(Gltf& gltf, std::span<const uint8_t> bin, Warnings& warnings) {
  gltf.buffers.resize(section_size(gltf.json, "buffers"));
  for (size_t i = 0; i < gltf.buffers.size(); ++i) {
    try {
      load_buffer(gltf, i, bin, warnings);
    } catch (const Error& error) {
      gltf.buffers[i] = {{}, false, error.what()};
    }
  }
}

}  // namespace

void warn_of_buffers(const Gltf& gltf, Warnings& warnings) {
  for (size_t i = 0; i < gltf.buffers.size(); ++i) {
    const Buffer& buffer = gltf.buffers[i];
    const std::string here = place(gltf.json, "buffers", i);
    if (!buffer.error.empty()) warnings.add(gltf.file, here, "cannot be read, but nothing in the scene uses it");
    if (buffer.error.empty() && !buffer.present && !is_fallback(gltf.json["buffers"][i])) {
      warnings.add(gltf.file, here, "has no data: no URI, and no GLB chunk");
    }
  }
}

Bytes read_uri(Gltf& gltf, const std::string& uri, const std::string& here, Warnings& warnings) {
  const std::string where = gltf.file + ": " + here;
  UriTarget target = resolve_uri(gltf.path.parent_path(), uri, where);
  if (target.backslashes) warnings.add(gltf.file, here, "breaks glTF: a backslash in its URI is taken as /");
  if (target.file.empty()) return bytes_of(std::move(target.data));
  gltf.files_read.push_back(target.file);
  return map_file(target.file, where);
}

bool is_present(const Gltf& gltf, int buffer_view) {
  const auto view = static_cast<size_t>(buffer_view);
  if (gltf.decoded_views[view].present || !gltf.decoded_views[view].error.empty()) return true;
  const Buffer& buffer = gltf.buffers[static_cast<size_t>(gltf.model.bufferViews[view].buffer)];
  return buffer.present || !buffer.error.empty();
}

std::span<const uint8_t> view_bytes(const Gltf& gltf, int buffer_view, const std::string& where) {
  const Buffer& decoded = gltf.decoded_views[static_cast<size_t>(buffer_view)];
  if (!decoded.error.empty()) throw Error(decoded.error);
  if (decoded.present) return decoded.data.bytes;
  const tinygltf::BufferView& view = gltf.model.bufferViews[static_cast<size_t>(buffer_view)];
  return buffer_bytes(gltf, static_cast<size_t>(view.buffer), view.byteOffset, view.byteLength,
                      where + ": buffer view " + std::to_string(buffer_view));
}

std::span<const uint8_t> buffer_bytes(const Gltf& gltf, size_t number, uint64_t offset, uint64_t length,
                                      const std::string& what) {
  const Buffer& buffer = gltf.buffers[number];
  if (!buffer.error.empty()) throw Error(buffer.error);
  const auto bytes = buffer.data.bytes;
  if (offset > bytes.size() || length > bytes.size() - offset) {
    throw Error(printable(what + " ends past buffer " + std::to_string(number) + " (" + std::to_string(offset) + " + " +
                          std::to_string(length) + " of " + std::to_string(bytes.size()) + " bytes)"));
  }
  return bytes.subspan(offset, length);
}

void check_extensions(const Json& json, const std::string& file, Warnings& warnings) {
  static const std::set<std::string> known = {"EXT_mesh_gpu_instancing",
                                              "EXT_meshopt_compression",
                                              "EXT_texture_webp",
                                              "KHR_draco_mesh_compression",
                                              "KHR_lights_punctual",
                                              "KHR_materials_emissive_strength",
                                              "KHR_materials_pbrSpecularGlossiness",
                                              "KHR_materials_transmission",
                                              "KHR_materials_unlit",
                                              "KHR_mesh_quantization",
                                              "KHR_meshopt_compression",
                                              "KHR_node_visibility",
                                              "KHR_texture_basisu",
                                              "KHR_texture_transform"};
  std::set<std::string> required;
  for (const char* key : {"extensionsRequired", "extensionsUsed"}) {
    const auto it = json.find(key);
    if (it == json.end()) continue;
    if (!it->is_array()) fail(file + ": " + key, "is not an array");
    for (const Json& name : *it) {
      if (!name.is_string())
        fail(file + ": " + key, "contains something other than a name (" + shortened(name.dump(), 60) + ")");
      if (known.contains(name.get<std::string>())) continue;
      const auto& text = name.get_ref<const std::string&>();
      if (key == std::string("extensionsRequired"))
        fail(file + ": extensionsRequired", "unknown extension (" + shortened(text, 80) + ")");
      warnings.add(file, "extensionsUsed", "unknown extension is ignored", text);
    }
  }
}

Gltf read_gltf(const std::filesystem::path& path, Warnings& warnings) {
  Gltf gltf;
  gltf.path = path;
  gltf.file = path.string();
  gltf.files_read = {path};
  gltf.container = map_file(path, gltf.file);
  refuse_other_kinds(gltf.container.bytes, gltf.file);
  const Chunks chunks = split_container(gltf.container.bytes, gltf.file, warnings);
  if (chunks.json.empty()) fail(gltf.file, "is not a glTF: it is empty");
  gltf.json = parse_json(chunks.json, gltf.file);
  if (chunks.json[0] == 0xEF) warnings.add(gltf.file, "JSON", "breaks glTF: it begins with a byte order mark");
  if (!gltf.json.is_object()) fail(gltf.file, "is not a glTF: the JSON is not an object");
  make_integers(gltf.json);
  check_extensions(gltf.json, gltf.file, warnings);
  check_gltf(gltf.json, gltf.file);
  lint_gltf(gltf.json, gltf.file, warnings);
  gltf.model = parse_model(gltf.json, gltf.file);
  load_buffers(gltf, chunks.bin, warnings);
  decode_meshopt_views(gltf);
  return gltf;
}

}  // namespace chandelier::baker
