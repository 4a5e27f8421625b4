// SPDX-License-Identifier: Apache-2.0
// Reads a .gltf or .glb: container, JSON, extensions, buffers. tinygltf turns the checked JSON into structs; files and
// data URIs are read here, since tinygltf reads past the end of short buffers and loses the place of an error.
#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <set>

#include "gltf.h"

namespace chandelier::baker {
namespace {

constexpr int kMostNesting = 200;  // of JSON: glTF needs about ten; parsers recurse
constexpr std::uint32_t kGlbMagic = 0x46546C67, kJsonChunk = 0x4E4F534A, kBinChunk = 0x004E4942;

std::uint32_t u32_at(std::span<const std::uint8_t> bytes, std::size_t offset) {
  std::uint32_t value = 0;
  std::memcpy(&value, bytes.data() + offset, 4);
  return value;
}

struct Chunks {
  std::span<const std::uint8_t> json, bin;
};

/// Splits a .glb; a .gltf is all JSON.
Chunks split_container(std::span<const std::uint8_t> bytes, const std::string& file) {
  if (bytes.size() < 4 || u32_at(bytes, 0) != kGlbMagic) return {bytes, {}};
  if (bytes.size() < 20) fail(file, "truncated GLB (" + std::to_string(bytes.size()) + " bytes)");
  if (u32_at(bytes, 4) != 2) fail(file, "GLB version is not 2 (" + std::to_string(u32_at(bytes, 4)) + ")");
  const std::uint64_t length = u32_at(bytes, 8);
  if (length > bytes.size()) {
    fail(file,
         "truncated GLB: header says " + std::to_string(length) + " bytes (" + std::to_string(bytes.size()) + ")");
  }
  Chunks chunks;
  for (std::uint64_t at = 12, number = 0; at < length; ++number) {
    const std::string where = file + ": GLB chunk " + std::to_string(number);
    if (length - at < 8) fail(where, "truncated (" + std::to_string(length - at) + " bytes left)");
    const std::uint64_t size = u32_at(bytes, at), type = u32_at(bytes, at + 4);
    if (size > length - at - 8) fail(where, "is longer than the file (" + std::to_string(size) + " bytes)");
    const auto data = bytes.subspan(at + 8, size);
    if (number == 0 && type != kJsonChunk) fail(where, "is not JSON (type " + std::to_string(type) + ")");
    if (number == 0) chunks.json = data;
    if (number == 1 && type == kBinChunk) chunks.bin = data;
    at += 8 + size;
  }
  return chunks;
}

void check_nesting(std::span<const std::uint8_t> text, const std::string& file) {
  int depth = 0;
  bool in_string = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = static_cast<char>(text[i]);
    if (in_string) {
      if (c == '\\') ++i;
      if (c == '"') in_string = false;
      continue;
    }
    if (c == '"') in_string = true;
    if (c == '{' || c == '[') ++depth;
    if (c == '}' || c == ']') --depth;
    if (depth > kMostNesting) fail(file, "JSON is nested too deeply (more than " + std::to_string(kMostNesting) + ")");
  }
}

Json parse_json(std::span<const std::uint8_t> text, const std::string& file) {
  check_nesting(text, file);
  try {
    return Json::parse(text.begin(), text.end());
  } catch (const Json::exception& error) {
    std::string what = error.what();  // "[json.exception.parse_error.101] parse error at line 1, ..."
    what = what.substr(what.find(']') == std::string::npos ? 0 : what.find(']') + 2);
    fail(file, "is not a glTF: " + shortened(what, 200));
  }
}

/// Calls `visit(primitive, mesh, number)`.
template <typename JsonOrConst, typename Visit>
void for_each_primitive(JsonOrConst& json, Visit visit) {
  if (!json.contains("meshes")) return;
  for (std::size_t m = 0; m < json["meshes"].size(); ++m) {
    auto& primitives = json["meshes"][m]["primitives"];
    for (std::size_t p = 0; p < primitives.size(); ++p) visit(primitives[p], m, p);
  }
}

/// tinygltf's structs for everything but files and the parts that the baker leaves out. It does not see indices: it
/// refuses those that are all sparse.
tinygltf::Model parse_model(const Json& json, const std::string& file) {
  Json reduced = json;
  for (const char* section : {"buffers", "images", "animations", "skins", "extras"}) reduced.erase(section);
  for_each_primitive(reduced, [](Json& primitive, std::size_t, std::size_t) { primitive.erase("indices"); });
  const std::string text = reduced.dump();
  if (text.size() > 0xFFFFFFFFu) fail(file, "JSON is too large (" + std::to_string(text.size()) + " bytes)");
  tinygltf::TinyGLTF parser;
  tinygltf::Model model;
  std::string error, warning;
  if (!parser.LoadASCIIFromString(&model, &error, &warning, text.c_str(), static_cast<unsigned>(text.size()), "")) {
    while (!error.empty() && error.back() == '\n') error.pop_back();
    fail(file, "is not a glTF: " + error);
  }
  for_each_primitive(json, [&](const Json& primitive, std::size_t mesh, std::size_t number) {
    model.meshes[mesh].primitives[number].indices = primitive.value("indices", -1);
  });
  return model;
}

int hex_digit(char c) {
  if (c >= '0' && c <= '9') return c - '0';
  if (c >= 'a' && c <= 'f') return c - 'a' + 10;
  if (c >= 'A' && c <= 'F') return c - 'A' + 10;
  return -1;
}

std::string percent_decode(const std::string& uri) {
  std::string out;
  for (std::size_t i = 0; i < uri.size(); ++i) {
    if (uri[i] == '%' && i + 2 < uri.size() && hex_digit(uri[i + 1]) >= 0 && hex_digit(uri[i + 2]) >= 0) {
      out += static_cast<char>(hex_digit(uri[i + 1]) * 16 + hex_digit(uri[i + 2]));
      i += 2;
    } else {
      out += uri[i];
    }
  }
  return out;
}

/// The start of a URI as a message shows it.
std::string shown(const std::string& uri) {
  return shortened(uri, 80);
}

std::vector<std::uint8_t> decode_base64(std::string_view text, const std::string& where) {
  std::vector<std::uint8_t> out;
  out.reserve(text.size() / 4 * 3 + 3);
  std::uint32_t bits = 0;
  int have = 0;
  while (!text.empty() && text.back() == '=') text.remove_suffix(1);
  for (const char c : text) {
    int value = -1;
    if (c >= 'A' && c <= 'Z') value = c - 'A';
    if (c >= 'a' && c <= 'z') value = c - 'a' + 26;
    if (c >= '0' && c <= '9') value = c - '0' + 52;
    if (c == '+' || c == '-') value = 62;
    if (c == '/' || c == '_') value = 63;
    if (value < 0) fail(where, std::string("data URI is not base64 ('") + c + "')");
    bits = bits << 6 | static_cast<std::uint32_t>(value);
    have += 6;
    if (have >= 8) {
      have -= 8;
      out.push_back(static_cast<std::uint8_t>(bits >> have));
    }
  }
  return out;
}

std::vector<std::uint8_t> read_data_uri(const std::string& uri, const std::string& where) {
  const std::size_t comma = uri.find(',');
  if (comma == std::string::npos) fail(where, "data URI has no data (" + shown(uri) + ")");
  const std::string_view header = std::string_view(uri).substr(0, comma);
  const std::string body = percent_decode(uri.substr(comma + 1));
  if (header.ends_with(";base64")) return decode_base64(body, where);
  return {body.begin(), body.end()};
}

/// "http" of "http://…"; empty for a relative reference.
std::string uri_scheme(const std::string& uri) {
  const std::size_t end = uri.find_first_of(":/?#");
  return end != std::string::npos && end > 0 && uri[end] == ':' ? uri.substr(0, end) : "";
}

void load_buffers(Gltf& gltf, std::span<const std::uint8_t> bin) {
  const auto it = gltf.json.find("buffers");
  if (it == gltf.json.end()) return;
  for (std::size_t i = 0; i < it->size(); ++i) {
    const Json& buffer = (*it)[i];
    const std::string where = gltf.file + ": " + place(gltf.json, "buffers", i);
    const auto length = buffer["byteLength"].get<std::uint64_t>();
    std::vector<std::uint8_t> data;
    if (buffer.contains("uri")) {
      data = read_uri(gltf, buffer["uri"].get<std::string>(), where, length);
    } else if (i == 0 && !bin.empty()) {
      data.assign(bin.begin(), bin.end());
    } else {
      gltf.buffers.emplace_back();  // an error only where something reads it: extensions may stand in for it
      continue;
    }
    if (data.size() < length) {
      fail(where,
           "is shorter than its byteLength " + std::to_string(length) + " (" + std::to_string(data.size()) + " bytes)");
    }
    data.resize(length);
    gltf.buffers.push_back(std::move(data));
  }
}

}  // namespace

std::vector<std::uint8_t> read_file(const std::filesystem::path& path, const std::string& where,
                                    std::uint64_t most_bytes) {
  std::error_code error;
  const auto status = std::filesystem::status(path, error);
  if (!std::filesystem::exists(status)) fail(where, "no such file (" + shortened(path.string(), 400) + ")");
  if (!std::filesystem::is_regular_file(status)) fail(where, "is not a file (" + shortened(path.string(), 400) + ")");
  const std::uint64_t size = std::filesystem::file_size(path, error);
  std::ifstream stream(path, std::ios::binary);
  if (error || !stream)
    fail(where, "cannot be read: " + std::string(std::strerror(errno)) + " (" + shortened(path.string(), 400) + ")");
  std::vector<std::uint8_t> bytes(std::min(size, most_bytes));
  stream.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  if (static_cast<std::size_t>(stream.gcount()) != bytes.size())
    fail(where, "cannot be read (" + shortened(path.string(), 400) + ")");
  return bytes;
}

std::vector<std::uint8_t> read_uri(Gltf& gltf, const std::string& uri, const std::string& where,
                                   std::uint64_t most_bytes) {
  const std::string scheme = uri_scheme(uri);
  if (scheme == "data") return read_data_uri(uri, where);
  if (!scheme.empty()) fail(where, "URI is not relative to the file (" + shown(uri) + ")");
  const std::string decoded = percent_decode(uri);
  if (decoded.empty() || decoded.find('\0') != std::string::npos) fail(where, "URI names no file (" + shown(uri) + ")");
  if (decoded[0] == '/' || decoded[0] == '\\') fail(where, "URI is not relative to the file (" + shown(uri) + ")");
  const std::filesystem::path folder = gltf.path.parent_path();
  std::error_code error;
  const bool literal =
      !std::filesystem::exists(folder / decoded, error) && std::filesystem::exists(folder / uri, error);
  gltf.files_read.push_back(folder / (literal ? uri : decoded));
  return read_file(gltf.files_read.back(), where, most_bytes);
}

std::span<const std::uint8_t> view_bytes(const Gltf& gltf, int buffer_view, const std::string& where) {
  const tinygltf::BufferView& view = gltf.model.bufferViews[static_cast<std::size_t>(buffer_view)];
  const auto& buffer = gltf.buffers[static_cast<std::size_t>(view.buffer)];
  if (view.byteOffset > buffer.size() || view.byteLength > buffer.size() - view.byteOffset) {
    fail(where, "buffer view " + std::to_string(buffer_view) + " ends past buffer " + std::to_string(view.buffer) +
                    " (" + std::to_string(view.byteOffset) + " + " + std::to_string(view.byteLength) + " of " +
                    std::to_string(buffer.size()) + " bytes)");
  }
  return std::span(buffer).subspan(view.byteOffset, view.byteLength);
}

void check_extensions(const Json& json, const std::string& file, Warnings& warnings) {
  static const std::set<std::string> kKnown = {"KHR_lights_punctual", "KHR_materials_emissive_strength",
                                               "KHR_mesh_quantization"};
  std::set<std::string> required;
  for (const char* key : {"extensionsRequired", "extensionsUsed"}) {
    const auto it = json.find(key);
    if (it == json.end()) continue;
    if (!it->is_array()) fail(file + ": " + key, "is not an array");
    for (const Json& name : *it) {
      if (!name.is_string())
        fail(file + ": " + key, "holds something else than a name (" + shortened(name.dump(), 60) + ")");
      if (kKnown.contains(name.get<std::string>())) continue;
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
  const std::vector<std::uint8_t> bytes = read_file(path, gltf.file);
  const Chunks chunks = split_container(bytes, gltf.file);
  if (chunks.json.empty()) fail(gltf.file, "is not a glTF: it is empty");
  gltf.json = parse_json(chunks.json, gltf.file);
  if (!gltf.json.is_object()) fail(gltf.file, "is not a glTF: the JSON is not an object");
  check_extensions(gltf.json, gltf.file, warnings);
  check_gltf(gltf.json, gltf.file);
  gltf.model = parse_model(gltf.json, gltf.file);
  load_buffers(gltf, chunks.bin);
  return gltf;
}

}  // namespace chandelier::baker
