// SPDX-License-Identifier: Apache-2.0
// A JSON object and its place in the file. Each member function checks one key; errors name the place and the value.
#pragma once

#include <cstdint>
#include <optional>

#include "gltf.h"

namespace chandelier::baker {

enum class Need { optional, required };

/// A value as a message shows it.
std::string shown(const Json& value);

/// The entries of a glTF array; 0 where there is none.
size_t section_size(const Json& json, const char* section);

constexpr double largest_number = 3e38;  // every number must fit a float
constexpr uint64_t largest_byte_count = 1ull << 53;
constexpr uint64_t largest_int = 0x7FFFFFFF;

struct Object {
  const Json& json;  // the object
  std::string where;

  [[noreturn]] void bad(const char* key, const std::string& what, const Json& value) const;
  const Json* find(const char* key, Need need = Need::optional) const;
  void text(const char* key, Need need = Need::optional) const;
  void boolean(const char* key) const;
  void integer(const char* key, uint64_t least, uint64_t most, Need need = Need::optional) const;
  void number(const char* key, double least, double most, Need need = Need::optional) const;
  void numbers(const char* key, size_t count, double least, double most) const;
  void index(const char* key, size_t count, Need need = Need::optional) const;
  void indices(const char* key, size_t count, Need need = Need::optional) const;
  std::optional<Object> object(const char* key, Need need = Need::optional) const;
  /// This object's data of an extension.
  std::optional<Object> extension(const char* name) const;
  /// The objects of an array.
  std::vector<Object> objects(const char* key, Need need = Need::optional) const;

  void check_number(const char* key, const Json& value, double least, double most) const;
  void check_index(const char* key, const Json& value, size_t count) const;
};

}  // namespace chandelier::baker
