// SPDX-License-Identifier: Apache-2.0
// Files and URIs. Large files are mapped, not copied. If another program shortens a mapped file, the bake ends by
// SIGBUS.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace chandelier::baker {

/// Bytes and their owner.
struct Bytes {
  std::span<const uint8_t> bytes;
  std::shared_ptr<const void> owner;
};

Bytes bytes_of(std::vector<uint8_t>&& data);

/// A regular file, mapped. Throws Error.
Bytes map_file(const std::filesystem::path& path, const std::string& where);

/// What a URI beside `folder` names: a file, or the bytes of a data URI.
struct UriTarget {
  std::filesystem::path file;  // empty for a data URI
  std::vector<uint8_t> data;
  bool backslashes = false;  // the file was found with / in their place
};

/// The file is searched for under the decoded URI, under its literal text, and with / for each backslash, as programs
/// on Windows write it. Throws Error if the URI is not a relative reference, or its data is not base64.
UriTarget resolve_uri(const std::filesystem::path& folder, const std::string& uri, const std::string& where);

}  // namespace chandelier::baker
