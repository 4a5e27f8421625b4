// SPDX-License-Identifier: Apache-2.0
// Makes small glTF files in tests: JSON with one buffer as a data URI.
#pragma once

#include <cstdint>
#include <cstring>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "bake/bake.h"
#include "error.h"
#include "scene.h"

namespace chandelier::baker::test {

using Json = nlohmann::json;

// glTF's numbers.
constexpr int byte_type = 5120, unsigned_byte_type = 5121, short_type = 5122, unsigned_short_type = 5123,
              unsigned_int_type = 5125, float_type = 5126;

struct GltfBuilder {
  Json json = {{"asset", {{"version", "2.0"}}}};
  std::vector<uint8_t> bytes;  // the buffer
  size_t fallback_bytes = 0;   // of a second one, without data: that of views that are compressed

  /// Appends data, aligned to 4 bytes, as a buffer view; returns its number.
  template <typename T>
  int add_view(const std::vector<T>& data, int byte_stride = 0) {
    bytes.resize((bytes.size() + 3) / 4 * 4);
    Json view = {{"buffer", 0}, {"byteOffset", bytes.size()}, {"byteLength", data.size() * sizeof(T)}};
    if (byte_stride) view["byteStride"] = byte_stride;
    const auto* from = reinterpret_cast<const uint8_t*>(data.data());
    bytes.insert(bytes.end(), from, from + data.size() * sizeof(T));
    return append("bufferViews", view);
  }

  /// An accessor over a view of its own.
  template <typename T>
  int add_accessor(const std::vector<T>& data, int component_type, const char* type, size_t count,
                   bool normalized = false) {
    Json accessor = {
        {"bufferView", add_view(data)}, {"componentType", component_type}, {"type", type}, {"count", count}};
    if (normalized) accessor["normalized"] = true;
    return append("accessors", accessor);
  }
  int add_floats(const std::vector<float>& data, const char* type, size_t components) {
    return add_accessor(data, float_type, type, data.size() / components);
  }
  /// With the bounds that glTF asks for, where they are numbers.
  int add_positions(const std::vector<float>& xyz);
  int add_indices(const std::vector<uint16_t>& indices) {
    return add_accessor(indices, unsigned_short_type, "SCALAR", indices.size());
  }

  /// A mesh of one primitive; returns the mesh's number.
  int add_mesh(const Json& primitive) { return append("meshes", {{"primitives", {primitive}}}); }
  /// A root node.
  int add_node(const Json& node) { return append("nodes", node); }

  int append(const char* section, const Json& entry) {
    json[section].push_back(entry);
    return static_cast<int>(json[section].size()) - 1;
  }

  /// The JSON text, with the buffer.
  std::string text() const;
  /// Writes NAME.gltf into this test's own folder.
  std::filesystem::path save(const std::string& name = "scene") const;
  Scene import(Warnings* warnings = nullptr) const;
  pack::Contents bake(const BakeSettings& settings = {}) const;
};

/// A triangle in the plane z = 0 whose front looks to +z, on a node of its own: (0,0) (1,0) (0,1).
GltfBuilder one_triangle();

/// A folder that this test process removes when it ends.
std::filesystem::path scratch_folder();
void write_bytes(const std::filesystem::path& path, const std::string& bytes);
std::string base64(const std::vector<uint8_t>& bytes);

/// Bakes without progress; the report and the warnings go unread.
pack::Contents bake_scene(Scene&& scene, const BakeSettings& settings);

/// What import and bake throw for a file: the error's line, or "" where they pass.
std::string error_of(const std::filesystem::path& path);

/// The text of a string in a pack.
std::string text_of(const pack::Contents& pack, const pack::StringRef& ref);

}  // namespace chandelier::baker::test
