// SPDX-License-Identifier: Apache-2.0
// The rules are those of schemas/light_extras.schema.json and shadow_extras.schema.json; tests compare them.
#include "extras.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace chandelier::baker {
namespace {

constexpr std::array<std::string_view, 1> shadow = {"shadow"};

/// The value of `extras.chandelier`, or nullptr.
const Json* find_extras(const Json& owner) {
  const auto all = owner.find("extras");
  if (all == owner.end() || !all->is_object() || !all->contains("chandelier")) return nullptr;
  return &(*all)["chandelier"];
}

}  // namespace

void Extras::bad(const char* key, const char* what, const Json& value) const {
  fail(where + ", " + key, std::string(what) + " (" + shortened(value.dump(-1, ' ', true), 60) + ")");
}

std::optional<bool> Extras::boolean(const char* key) const {
  const auto it = json.find(key);
  if (it == json.end()) return std::nullopt;
  if (!it->is_boolean()) bad(key, "is not true or false", *it);
  return it->get<bool>();
}

std::optional<std::string> Extras::text(const char* key) const {
  const auto it = json.find(key);
  if (it == json.end()) return std::nullopt;
  if (!it->is_string()) bad(key, "is not a string", *it);
  return it->get<std::string>();
}

std::optional<double> Extras::number(const char* key, double least, double most) const {
  const auto it = json.find(key);
  if (it == json.end()) return std::nullopt;
  if (!it->is_number()) bad(key, "is not a number", *it);
  const auto value = it->get<double>();
  if (!(value >= least && value <= most)) bad(key, "is out of range", *it);
  return value;
}

std::optional<uint32_t> Extras::integer(const char* key, double least, double most) const {
  const auto value = number(key, least, most);
  if (!value) return std::nullopt;
  if (*value != std::floor(*value)) bad(key, "is not a whole number", json[key]);
  return static_cast<uint32_t>(*value);
}

std::optional<Extras> extras_of(const Gltf& gltf, const Json& owner, const std::string& here,
                                std::span<const std::string_view> known, Warnings& warnings) {
  const Json* json = find_extras(owner);
  if (!json) return std::nullopt;
  const Extras extras{*json, gltf.file + ": " + here + ", extras.chandelier"};
  if (!json->is_object()) {
    fail(extras.where, "is not an object (" + shortened(json->dump(-1, ' ', true), 60) + ")");
  }
  for (const auto& [key, value] : json->items()) {
    if (known.empty() || std::find(known.begin(), known.end(), key) != known.end()) continue;
    warnings.add(gltf.file, here, "extras.chandelier: unknown key is ignored", key.empty() ? "an empty name" : key);
  }
  return extras;
}

bool is_shadowless(const Gltf& gltf, size_t number, Warnings& warnings) {
  static const Json::json_pointer light("/extensions/KHR_lights_punctual");
  const Json& node = gltf.json["nodes"][number];
  const std::string here = place(gltf.json, "nodes", number);
  const bool has_light = node.contains(light);
  if (!node.contains("mesh")) {
    const Json* json = find_extras(node);
    if (json && json->is_object() && json->contains("shadow") && !has_light) {
      warnings.add(
          gltf.file, here,
          "extras.chandelier.shadow of a node without mesh and light is ignored: it does not apply to children");
    }
    return false;
  }
  std::span<const std::string_view> known = shadow;
  if (has_light) known = {};  // the light's import warns of its keys
  const auto extras = extras_of(gltf, node, here, known, warnings);
  return extras && !extras->boolean("shadow").value_or(true);
}

std::optional<bool> shadow_of_material(const Gltf& gltf, size_t number, Warnings& warnings) {
  const Json& material = gltf.json["materials"][number];
  const auto extras = extras_of(gltf, material, place(gltf.json, "materials", number), shadow, warnings);
  return extras ? extras->boolean("shadow") : std::nullopt;
}

}  // namespace chandelier::baker
