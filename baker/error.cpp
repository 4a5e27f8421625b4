// SPDX-License-Identifier: Apache-2.0
// Messages are one line each, whatever a file's names and URIs contain.
#include "error.h"

#include <fmt/core.h>

#include <algorithm>

namespace chandelier::baker {
namespace {

constexpr size_t most_message_bytes = 4000;  // a path can be that long
constexpr uint64_t most_names = 3;           // in one warning
constexpr uint32_t no_character = 0xFFFFFFFFu;

struct Character {
  uint32_t code;  // no_character: a byte that begins none
  size_t bytes;
};

Character character_at(const std::string& text, size_t at) {
  const auto byte = [&](size_t i) { return static_cast<uint8_t>(text[i]); };
  const uint8_t first = byte(at);
  if (first < 0x80) return {first, 1};
  const size_t size = first >= 0xF0 ? 4 : first >= 0xE0 ? 3 : 2;
  if (first < 0xC2 || first > 0xF4 || at + size > text.size()) return {no_character, 1};
  uint32_t code = first & (0x7Fu >> size);
  for (size_t i = 1; i < size; ++i) {
    if ((byte(at + i) & 0xC0) != 0x80) return {no_character, 1};
    code = code << 6 | (byte(at + i) & 0x3Fu);
  }
  return {code, size};
}

/// C0, DEL, C1, and Unicode's separators of lines and paragraphs.
bool is_control(uint32_t code) {
  return code < 0x20 || (code >= 0x7F && code < 0xA0) || code == 0x2028 || code == 0x2029;
}

}  // namespace

std::string shortened(const std::string& text, size_t most_bytes) {
  if (text.size() <= most_bytes) return text;
  size_t end = most_bytes > 3 ? most_bytes - 3 : 0;
  while (end > 0 && (static_cast<uint8_t>(text[end]) & 0xC0) == 0x80) --end;  // inside a character
  return text.substr(0, end) + "...";
}

std::string printable(const std::string& text) {
  const std::string part = shortened(text, most_message_bytes);
  std::string out;
  for (size_t at = 0; at < part.size();) {
    const Character character = character_at(part, at);
    if (character.code == '\n') {
      out += "\\n";
    } else if (character.code == no_character) {
      out += fmt::format("\\x{:02x}", static_cast<uint8_t>(part[at]));
    } else if (is_control(character.code)) {
      out += fmt::format("\\u{:04x}", character.code);
    } else {
      out += part.substr(at, character.bytes);
    }
    at += character.bytes;
  }
  return out;
}

std::string to_text(double number) {
  return fmt::format("{:.9g}", number);
}

void fail(const std::string& where, const std::string& what) {
  throw Error(printable(where) + ": " + printable(what));
}

uint32_t fit_u32(uint64_t count, const char* what) {
  if (count >= 0xFFFFFFFFu) fail("scene", fmt::format("too many {} for one pack ({})", what, count));
  return static_cast<uint32_t>(count);
}

void Warnings::add(const std::string& file, const std::string& where, const std::string& what,
                   const std::string& name) {
  const auto [it, added] = numbers_.try_emplace({file, what}, entries_.size());
  if (added) entries_.push_back({printable(file), printable(where), printable(what), "", 0});
  Entry& entry = entries_[it->second];
  if (!name.empty() && entry.count < most_names) {
    entry.names += (entry.names.empty() ? "" : ", ") + printable(shortened(name, 80));
  }
  ++entry.count;
}

uint64_t Warnings::count() const {
  uint64_t count = 0;
  for (const Entry& entry : entries_) count += entry.count;
  return count;
}

std::vector<std::string> Warnings::lines() const {
  std::vector<std::string> out;
  for (const Entry& entry : entries_) {
    const uint64_t shown = entry.names.empty() ? 1 : std::min(entry.count, most_names);
    const std::string more = entry.count > shown ? fmt::format("and {} more", entry.count - shown) : "";
    if (entry.names.empty()) {
      out.push_back(
          fmt::format("{}: {}{}: {}", entry.file, entry.where, more.empty() ? "" : " (" + more + ")", entry.what));
    } else {
      out.push_back(fmt::format("{}: {}: {} ({}{})", entry.file, entry.where, entry.what, entry.names,
                                more.empty() ? "" : " " + more));
    }
  }
  return out;
}

}  // namespace chandelier::baker
