// SPDX-License-Identifier: Apache-2.0
// What a file is that is not what a program asked for, by its first bytes; and what to do with it.
#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>

namespace chandelier::pack {

enum class FileKind { unknown, pack, gltf, json, other };
struct KnownFile {
  FileKind kind = FileKind::unknown;
  std::string name;    // "a Blender file"; empty where it is unknown
  std::string advice;  // how to make a glTF of it; empty where that is nothing to expect
};
KnownFile known_file(const std::filesystem::path& path, std::span<const std::byte> bytes);

/// For one who asked for a pack: what is there instead, and how to get a pack.
std::string no_pack(const std::filesystem::path& path, std::span<const std::byte> bytes);

}  // namespace chandelier::pack
