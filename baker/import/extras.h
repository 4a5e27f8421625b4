// SPDX-License-Identifier: Apache-2.0
// What an author adds in `extras.chandelier`: to a light (light_extras.schema.json), or to a mesh's node or a material
// (shadow_extras.schema.json).
#pragma once

#include <optional>
#include <span>
#include <string_view>

#include "gltf.h"

namespace chandelier::baker {

/// One `extras.chandelier` and where it is; each member function reads one of its keys, where it is there. Throws Error
/// where its value breaks a rule.
struct Extras {
  const Json& json;
  std::string where;

  std::optional<bool> boolean(const char* key) const;
  std::optional<std::string> text(const char* key) const;
  std::optional<double> number(const char* key, double least, double most) const;
  /// JSON Schema's integer: 128.0 is one.
  std::optional<std::uint32_t> integer(const char* key, double least, double most) const;

  [[noreturn]] void bad(const char* key, const char* what, const Json& value) const;
};

/// Of `owner`, which is `here` in the file. A key that is not `known` may be a typing error: that is said, as it
/// changes nothing; with none known nothing is said. Throws Error where it is no object.
std::optional<Extras> extras_of(const Gltf& gltf, const Json& owner, const std::string& here,
                                std::span<const std::string_view> known, Warnings& warnings);

/// Whether the node's author wants its own mesh to throw no shadow. Children are not asked about. Throws Error.
bool is_shadowless(const Gltf& gltf, std::size_t node, Warnings& warnings);

/// Whether the material's author wants a shadow of it, where that is said. Throws Error.
std::optional<bool> shadow_of_material(const Gltf& gltf, std::size_t material, Warnings& warnings);

}  // namespace chandelier::baker
