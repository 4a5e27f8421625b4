// SPDX-License-Identifier: Apache-2.0
// How the baker says that an input cannot be baked, or that it was baked with something left out.
#pragma once

#include <cstdint>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace chandelier::baker {

/// Bad input. what() is one line: file, place, what is wrong, the offending value.
struct Error : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// `where: what`, thrown.
[[noreturn]] inline void fail(const std::string& where, const std::string& what) {
  throw Error(where + ": " + what);
}

/// A count that must fit the pack's 32-bit indices.
inline std::uint32_t fit_u32(std::uint64_t count, const char* what) {
  if (count >= 0xFFFFFFFFu)
    fail("scene", std::string("too many ") + what + " for one pack (" + std::to_string(count) + ")");
  return static_cast<std::uint32_t>(count);
}

/// Warnings, one line per kind and file however often they occur.
class Warnings {
 public:
  void add(const std::string& file, const std::string& where, const std::string& what) {
    for (Entry& entry : entries_) {
      if (entry.file == file && entry.what == what) {
        ++entry.count;
        return;
      }
    }
    entries_.push_back({file, where, what, 1});
  }

  std::vector<std::string> lines() const {
    std::vector<std::string> out;
    for (const Entry& entry : entries_) {
      const std::string more = entry.count > 1 ? " (and " + std::to_string(entry.count - 1) + " more)" : "";
      out.push_back(entry.file + ": " + entry.where + more + ": " + entry.what);
    }
    return out;
  }

 private:
  struct Entry {
    std::string file, where, what;
    std::uint64_t count;
  };
  std::vector<Entry> entries_;
};

}  // namespace chandelier::baker
