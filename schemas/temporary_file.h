// SPDX-License-Identifier: Apache-2.0
// A file that gets its name only when it is complete.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string_view>

namespace chandelier::pack {

enum class Sync { yes, no };

/// Writes beside `path` and renames over it. Until then an older file at `path` stays as it is. Every failure is thrown
/// as pack::Error.
class TemporaryFile {
 public:
  explicit TemporaryFile(const std::filesystem::path& path);
  ~TemporaryFile();
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;

  /// Any thread may call it. What no call fills up to the file's end is zero.
  void write(uint64_t offset, const void* data, size_t size);

  /// Waits until all that was written is on the disk. Any thread may call it, after the last write().
  void sync();

  /// Puts the file in its place. Without `sync`, a power failure soon after may leave an empty or damaged file there.
  void commit(Sync sync);

 private:
  bool create(const std::filesystem::path& folder);

  std::filesystem::path path_, temporary_;
  int descriptor_ = -1;
  bool synced_ = false;
};

/// Writes all of `text`, as above.
void write_text(const std::filesystem::path& path, std::string_view text);

/// Deletes files in `folder` whose writers were killed. Writers that still run hold a lock on theirs, so those stay.
void remove_stale_files(const std::filesystem::path& folder);

}  // namespace chandelier::pack
