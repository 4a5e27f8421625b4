// SPDX-License-Identifier: Apache-2.0
// How the rules between fields write numbers and places.
#pragma once

#include <charconv>
#include <concepts>
#include <cstddef>
#include <string>

namespace chandelier::pack {

/// The shortest that reads back as the same.
inline std::string text(float value) {
  char buffer[32];
  return std::string(buffer, std::to_chars(buffer, buffer + sizeof(buffer), value).ptr);
}

inline std::string text(std::unsigned_integral auto value) {
  return std::to_string(value);
}

inline std::string at(const char* section, size_t i) {
  return std::string(section) + "[" + text(i) + "]";
}

}  // namespace chandelier::pack
