// SPDX-License-Identifier: Apache-2.0
// Reads the author's `extras.chandelier` of a light (light_extras.schema.json), or of a mesh's node or a material
// (shadow_extras.schema.json).
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

#include "gltf.h"

namespace chandelier::baker {

/// One `extras.chandelier` and its place in the file. Each member function reads one key, if it is there, and throws
/// Error if its value breaks a rule.
struct Extras {
  const Json& json;
  std::string where;

  std::optional<bool> boolean(const char* key) const;
  std::optional<std::string> text(const char* key) const;
  std::optional<double> number(const char* key, double least, double most) const;
  /// JSON Schema's integer: 128.0 is one.
  std::optional<uint32_t> integer(const char* key, double least, double most) const;

  [[noreturn]] void bad(const char* key, const char* what, const Json& value) const;
};

/// The extras of `owner`, whose place in the file is `here`. Warns of a key that is not in `known`, which may be a
/// typing error; no warnings if `known` is empty. Throws Error if it is not an object.
std::optional<Extras> extras_of(const Gltf& gltf, const Json& owner, const std::string& here,
                                std::span<const std::string_view> known, Warnings& warnings);

/// Whether the node's author wants its own mesh to cast no shadow. Children are not affected. Throws Error.
bool is_shadowless(const Gltf& gltf, size_t node, Warnings& warnings);

/// Whether the material's author wants it to cast a shadow, if the extras say so. Throws Error.
std::optional<bool> shadow_of_material(const Gltf& gltf, size_t material, Warnings& warnings);

}  // namespace chandelier::baker
