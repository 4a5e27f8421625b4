// SPDX-License-Identifier: Apache-2.0
// Warnings for breaches of glTF 2.0 that do not affect the bake.
#pragma once

#include <cstdint>

#include "json_object.h"

namespace chandelier::baker {

/// Warns of everything in a checked glTF that breaks the specification.
void lint_gltf(const Json& json, const std::string& file, Warnings& warnings);

/// Shared by both files of the lint.
struct Lint {
  const Json& json;
  const std::string& file;
  Warnings& warnings;

  void warn(const char* section, size_t index, const std::string& what) const {
    warnings.add(file, place(json, section, index), "breaks glTF: " + what);
  }
  const Json& entry(const char* section, size_t index) const { return json[section][index]; }
  /// The buffer view of an accessor, or an empty object.
  const Json& view_of(const Json& accessor) const;
};

/// Bytes of one element of a checked accessor; 0 for a type that glTF lacks.
uint64_t element_bytes(const Json& accessor);

/// The whole number under a key, or `otherwise` if there is none.
uint64_t whole(const Json& object, const char* key, uint64_t otherwise);

void lint_meshes(const Lint& lint);

/// Warns of keys that glTF does not define and nothing reads, most likely typing errors.
void lint_keys(const Lint& lint);

}  // namespace chandelier::baker
