// SPDX-License-Identifier: Apache-2.0
// Writes a pack atomically; opens one by mapping it and checking everything before anything is used.
#pragma once

#include <cstdint>
#include <filesystem>
#include <future>
#include <span>
#include <stdexcept>
#include <string_view>
#include <utility>

#include "pack_schema.h"  // generated from pack.xml: records, enums, Contents (owning vectors), View (spans), validate()
#include "temporary_file.h"

namespace chandelier::pack {

/// A pack that cannot be read or written. what() is one line: file, place, what is wrong, the offending value.
struct Error : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// `smallest` stores each section and each image with the codec that makes it smallest: slower to write. Sections are
/// decoded when the pack is opened, images where they are needed (pack_images.h).
enum class Compression { off, smallest };

/// Writes `contents` to a temporary file beside `path`, syncs it and renames it over `path`; on failure nothing is left
/// behind and an older pack stays. Same contents, same bytes. Values are not looked at: check() of pack_checks.h says
/// beforehand whether the pack will open. Big packs are written in at most `most_threads` threads; 0: as many as there
/// are cores. Throws Error.
void write(const std::filesystem::path& path, const Contents& contents, Compression compression = Compression::off,
           size_t most_threads = 0);
void write(const std::filesystem::path& path, const View& view, Sync sync, Compression compression = Compression::off,
           size_t most_threads = 0);

/// write() in two steps, between which the disk works on its own.
class Writer {
 public:
  /// Writes the temporary file and begins to sync it. `contents` are not needed any more. Throws Error.
  Writer(const std::filesystem::path& path, const Contents& contents, Compression compression, size_t most_threads = 0);
  Writer(const Writer&) = delete;
  uint64_t size_bytes() const { return size_bytes_; }
  /// Waits for the disk. Throws Error.
  void sync();
  /// The same, and puts the file in its place; without it nothing is left behind. Throws Error.
  void commit();

 private:
  TemporaryFile file_;
  uint64_t size_bytes_;
  std::future<void> syncing_;  // waits before file_ goes
};

/// Memory from mmap(), of a file or not.
class Mapping {
 public:
  Mapping() = default;
  Mapping(void* data, size_t size) : data_(data), size_(size) {}
  ~Mapping();
  Mapping(Mapping&& other) noexcept
      : data_(std::exchange(other.data_, nullptr)), size_(std::exchange(other.size_, 0)) {}
  Mapping& operator=(Mapping&& other) noexcept {
    std::swap(data_, other.data_);
    std::swap(size_, other.size_);
    return *this;
  }
  std::span<std::byte> bytes() const { return {static_cast<std::byte*>(data_), size_}; }

 private:
  void* data_ = nullptr;
  size_t size_ = 0;
};

/// A mapped file must not be written to while it is used. If another program shortens it, the system ends the reader by
/// SIGBUS; changed bytes have not been checked. Replacing the file by renaming another over it is safe. A copy takes
/// the file's size in memory.
enum class Hold { mapped, copied };

/// A pack in memory. Every offset, count, index, enum and float has been checked when the constructor returns; but
/// texels of coded images, which texels_of() of pack_images.h checks when it decodes them.
class File {
 public:
  /// Checks and decodes big packs in at most `most_threads` threads; 0: as many as there are cores. Throws Error.
  explicit File(const std::filesystem::path& path, size_t most_threads = 0, Hold hold = Hold::mapped);
  File(File&& other) noexcept;
  File& operator=(File&& other) noexcept;

  /// One span per section; empty where the pack has none. Valid as long as the File.
  const View& view() const { return view_; }
  /// The text of a string of this pack.
  std::string_view text(const StringRef& ref) const;
  size_t size_bytes() const { return file_.bytes().size(); }
  /// How each section that is not empty is stored.
  std::span<const SectionEntry> table() const { return table_; }

 private:
  Mapping file_;
  Mapping decoded_;  ///< What codecs made of sections that are not raw.
  View view_;
  std::span<const SectionEntry> table_;
};

}  // namespace chandelier::pack
