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

namespace chandelier::baker {

using Json = nlohmann::json;

struct Gltf {
  std::filesystem::path path;
  std::string file;                                // the path as the user typed it, for messages
  std::vector<std::filesystem::path> files_read;   // the glTF and those beside it
  Json json;                                       // checked by check_gltf
  tinygltf::Model model;                           // the same, as structs; without buffers, images, skins, animations
  std::vector<std::vector<std::uint8_t>> buffers;  // empty where a buffer has no data of its own
};

/// Reads the container (.gltf or .glb), parses and checks the JSON, loads the buffers. Throws Error.
Gltf read_gltf(const std::filesystem::path& path, Warnings& warnings);

/// Checks types, ranges and references of everything that the importer reads from `json`. Throws Error.
/// tinygltf takes a default where a value has the wrong type, so it is not asked before this has passed.
void check_gltf(const Json& json, const std::string& file);

/// Refuses required extensions that the importer does not know; warns of others that are used.
void check_extensions(const Json& json, const std::string& file, Warnings& warnings);

/// "mesh 3 'name'", or "mesh 3" where it has no name. `section` is the glTF array ("meshes").
std::string place(const Json& json, const char* section, std::size_t index);

/// The first `most_bytes` bytes of a regular file. Throws Error.
std::vector<std::uint8_t> read_file(const std::filesystem::path& path, const std::string& where,
                                    std::uint64_t most_bytes = UINT64_MAX);

/// The bytes of a data URI or of a file beside the glTF, which is noted in files_read. Throws Error.
std::vector<std::uint8_t> read_uri(Gltf& gltf, const std::string& uri, const std::string& where,
                                   std::uint64_t most_bytes = UINT64_MAX);

/// The bytes of a buffer view. Throws Error where they are not all there.
std::span<const std::uint8_t> view_bytes(const Gltf& gltf, int buffer_view, const std::string& where);

}  // namespace chandelier::baker
