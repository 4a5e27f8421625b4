// SPDX-License-Identifier: Apache-2.0
// A glTF file, read and checked; private to import/.
#pragma once

#include <tiny_gltf.h>

#include <cstdint>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <vector>

#include "../error.h"
#include "files.h"

namespace chandelier::baker {

using Json = nlohmann::json;

/// A buffer, or a buffer view that was decoded.
struct Buffer {
  Bytes data;
  bool present = false;
  std::string error;  // why it cannot be read; thrown when something reads it
};

struct Gltf {
  std::filesystem::path path;
  std::string file;                               // the path as the user typed it, for messages
  std::vector<std::filesystem::path> files_read;  // the glTF and those beside it
  Bytes container;                                // the glTF itself
  Json json;                                      // checked by check_gltf
  tinygltf::Model model;                          // the same, as structs; without buffers, images, skins, animations
  std::vector<Buffer> buffers;                    // not present if the data comes from an extension or is missing
  std::vector<Buffer> decoded_views;              // one per buffer view; present where an extension compresses it
};

/// Reads the container (.gltf or .glb), parses and checks the JSON, loads the buffers. Throws Error.
Gltf read_gltf(const std::filesystem::path& path, Warnings& warnings);

/// Checks types, ranges and references of everything that the importer reads from `json`. Throws Error.
/// tinygltf takes a default where a value has the wrong type, so it is not asked before this has passed.
void check_gltf(const Json& json, const std::string& file);

/// Refuses required extensions that the importer does not know; warns of others that are used.
void check_extensions(const Json& json, const std::string& file, Warnings& warnings);

/// "mesh 3 'name'", or "mesh 3" where it has no name. `section` is the glTF array ("meshes").
std::string place(const Json& json, const char* section, size_t index);

/// Whether `type` is one of glTF's types, SCALAR to MAT4.
bool is_accessor_type(const std::string& type);

/// The bytes of a data URI or of a file beside the glTF, which is noted in files_read. `here`: the place in the file
/// that has the URI. Throws Error.
Bytes read_uri(Gltf& gltf, const std::string& uri, const std::string& here, Warnings& warnings);

/// Warns of buffers that could not be read. If the scene needs one, the import has failed before.
void warn_of_buffers(const Gltf& gltf, Warnings& warnings);

/// Whether the file says where the bytes of a buffer view are.
bool is_present(const Gltf& gltf, int buffer_view);

/// The bytes of a buffer view. Throws Error if some are missing.
std::span<const uint8_t> view_bytes(const Gltf& gltf, int buffer_view, const std::string& where);

/// Part of a buffer. Throws Error, beginning with `what`, if the buffer is too short.
std::span<const uint8_t> buffer_bytes(const Gltf& gltf, size_t buffer, uint64_t offset, uint64_t length,
                                      const std::string& what);

}  // namespace chandelier::baker
