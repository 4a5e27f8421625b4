// SPDX-License-Identifier: Apache-2.0
// A small pack that has something in every section, and what tests do with files.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "pack_file.h"

namespace chandelier::pack::test {

/// Valid. pack_python_test.py knows its values.
Contents sample();

/// A wavy sheet of `side` times `side` vertices whose positions are multiples of 2^-10: long sections, and nothing
/// drawn. Valid. pack_python_test.py knows its values.
Contents sheet(uint32_t side);

/// Appends to the strings section.
StringRef add_string(Contents& contents, std::string_view text);

/// A folder of its own that is deleted with everything in it.
class Folder {
 public:
  Folder();
  ~Folder();
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  std::filesystem::path operator/(const std::string& name) const { return path_ / name; }
  /// Names of what is in it.
  std::vector<std::string> names() const;

 private:
  std::filesystem::path path_;
};

std::vector<char> read_file(const std::filesystem::path& path);
void write_file(const std::filesystem::path& path, const std::vector<char>& bytes);

/// What opening the file throws, without the path; empty if it opens.
std::string open_error(const std::filesystem::path& path);

}  // namespace chandelier::pack::test
