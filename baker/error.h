// SPDX-License-Identifier: Apache-2.0
// Errors and warnings of the baker, and how their text is made printable.
#pragma once

#include <cstdint>
#include <map>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace chandelier::baker {

/// Bad input. what() is one line: file, place, what is wrong, the offending value.
struct Error : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// At most `most_bytes` of a UTF-8 text, cut between characters, with "..." if something is left out.
std::string shortened(const std::string& text, size_t most_bytes);

/// The text as a message shows it: control characters, line separators and invalid UTF-8 as escapes, and of limited
/// length.
std::string printable(const std::string& text);

/// A number as short as it can be.
std::string to_text(double number);

/// `where: what`, made printable and thrown.
[[noreturn]] void fail(const std::string& where, const std::string& what);

/// A count that must fit the pack's 32-bit indices.
uint32_t fit_u32(uint64_t count, const char* what);

/// Warnings, one line per kind and file however often they occur.
class Warnings {
 public:
  /// `name`: the thing that the warning is about, if `where` does not name it.
  void add(const std::string& file, const std::string& where, const std::string& what, const std::string& name = "");

  /// The number of warnings, counting each repetition.
  uint64_t count() const;

  /// `file: where (and 3 more): what`, or with names `file: where: what (A, B, C and 3 more)`, in the order of adding.
  std::vector<std::string> lines() const;

 private:
  struct Entry {
    std::string file, where, what, names;
    uint64_t count = 0;
  };
  std::vector<Entry> entries_;
  std::map<std::pair<std::string, std::string>, size_t> numbers_;  // of entries, by file and what
};

}  // namespace chandelier::baker
