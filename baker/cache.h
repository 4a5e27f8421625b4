// SPDX-License-Identifier: Apache-2.0
// Keeps results of bakes, named by a hash of their inputs (--cache). An entry is a pack, and is checked as any pack is:
// a damaged or foreign one is a miss.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "error.h"
#include "pack_file.h"

namespace chandelier::baker {

/// Hashes everything that a stage's result depends on. Every key contains the build of the baker and of its libraries.
class CacheKey {
 public:
  explicit CacheKey(std::string stage);

  /// Numbers only: padding would make keys differ by chance.
  template <typename T>
  requires(std::is_arithmetic_v<T> || std::is_enum_v<T>) void add(T value) { add_bytes(&value, sizeof(T)); }
  /// `Record` must have no padding.
  template <typename Record>
  void add_records(const std::vector<Record>& records) {
    add(uint64_t{records.size()});
    add_bytes(records.data(), records.size() * sizeof(Record));
  }
  void add_text(std::string_view text);

  /// "STAGE-" and 32 hexadecimal digits.
  std::string name() const;

 private:
  void add_bytes(const void* data, size_t size);

  std::string stage_;
  std::shared_ptr<void> state_;  // of XXH3
};

/// An entry that was found.
struct CacheEntry {
  pack::File pack;
  std::string notes;  // as they were given to store()
};

/// Any thread may call any function.
class Cache {
 public:
  /// A cache that is off: it finds and keeps nothing.
  Cache() = default;
  /// Makes the folder if it is missing. Throws Error.
  explicit Cache(const std::filesystem::path& folder);

  bool is_on() const { return !folder_.empty(); }
  const std::filesystem::path& folder() const { return folder_; }

  std::unique_ptr<CacheEntry> load(const std::string& name);

  /// Reports a fault of an entry that was found; the entry becomes a miss.
  void reject(const std::string& name, const std::string& fault);

  /// An entry that cannot be written is a warning. `sections`' bake_info and strings are kept too; its source is not.
  void store(const std::string& name, const pack::View& sections, const std::string& notes);

  /// Adds warnings for all faults, in the order of the entries' names.
  void warn(Warnings& warnings) const;

  /// For each requested entry, whether it was there.
  const std::map<std::string, bool>& loads() const { return loads_; }

 private:
  std::filesystem::path path_of(const std::string& name) const;

  std::filesystem::path folder_;
  mutable std::mutex mutex_;
  std::map<std::string, bool> loads_;
  std::map<std::string, std::string> faults_;  // by the entry's name
};

}  // namespace chandelier::baker
