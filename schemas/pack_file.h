// SPDX-License-Identifier: Apache-2.0
// Writes a pack atomically; opens one by mapping it and checking everything before anything is used.
#pragma once

#include <filesystem>
#include <stdexcept>
#include <string_view>

#include "pack_schema.h"  // generated from pack.xml: records, enums, Contents (owning vectors), View (spans), validate()
#include "temporary_file.h"

namespace chandelier::pack {

/// A pack that cannot be read or written. what() is one line: file, place, what is wrong, the offending value.
struct Error : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Writes `contents` to a temporary file beside `path`, syncs it and renames it over `path`; on failure nothing is left
/// behind and an older pack stays. Same contents, same bytes. Values are not looked at: check() of pack_checks.h says
/// beforehand whether the pack will open. Throws Error.
void write(const std::filesystem::path& path, const Contents& contents);
void write(const std::filesystem::path& path, const View& view, Sync sync);

/// A mapped pack. Every offset, count, index, enum and float has been checked when the constructor returns.
class File {
 public:
  /// Throws Error.
  explicit File(const std::filesystem::path& path);
  ~File();
  File(File&& other) noexcept;
  File& operator=(File&& other) noexcept;
  File(const File&) = delete;
  File& operator=(const File&) = delete;

  /// One span per section; empty where the pack has none. Valid as long as the File.
  const View& view() const { return view_; }
  /// The text of a string of this pack.
  std::string_view text(const StringRef& ref) const;
  std::size_t size_bytes() const { return size_; }

 private:
  void* data_ = nullptr;
  std::size_t size_ = 0;
  View view_;
};

}  // namespace chandelier::pack
