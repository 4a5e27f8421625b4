// SPDX-License-Identifier: Apache-2.0
// Recognizes a file of the wrong kind by its first bytes, and tells what to do with it.
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
  std::string advice;  // how to make a glTF from it; empty if that is not possible
};
KnownFile known_file(const std::filesystem::path& path, std::span<const std::byte> bytes);

/// A message for a program that expected a pack: what the file is, and how to get a pack.
std::string no_pack(const std::filesystem::path& path, std::span<const std::byte> bytes);

}  // namespace chandelier::pack
