// SPDX-License-Identifier: Apache-2.0
// KHR_lights_punctual, and what a light's author adds in `extras.chandelier`: on the light, or on the node, which wins.
// The rules are those of schemas/light_extras.schema.json; a test compares the two.
#include "lights.h"

#include <algorithm>
#include <array>
#include <optional>
#include <string_view>

#include "extras.h"

namespace chandelier::baker {
namespace {

constexpr std::array<std::string_view, 8> known_keys = {"cluster",  "dynamic",  "group",   "power_w",
                                                        "priority", "radius_m", "range_m", "shadow"};
constexpr double most_priority = 255, most_power = 1e12, least_range = 1e-12, most_range = 3e38, most_radius = 1e6;

/// 0 stands for none.
std::optional<double> range_in(const Extras& extras, const char* key) {
  const auto value = extras.number(key, 0, most_range);
  if (value && *value > 0 && *value < least_range) extras.bad(key, "is out of range", extras.json[key]);
  return value;
}

void warn_of_range(const Gltf& gltf, const Light& light, const std::string& here, Warnings& warnings) {
  if (light.type == LightType::directional) return;  // a sun has no range
  warnings.add(gltf.file, here, "a light's range of 0 is taken as none: it ends where --range-threshold says");
}

/// `owner`: a node or a light.
void read_extras(const Gltf& gltf, const Json& owner, const std::string& here, Light& out, Warnings& warnings) {
  const std::optional<Extras> found = extras_of(gltf, owner, here, known_keys, warnings);
  if (!found) return;
  const Extras& extras = *found;
  if (const auto value = extras.integer("priority", 0, most_priority)) out.priority = *value;
  if (const auto value = extras.boolean("dynamic")) out.dynamic = *value;
  if (const auto value = extras.boolean("cluster")) out.unclustered = !*value;
  if (const auto value = extras.boolean("shadow")) out.shadowless = !*value;
  if (const auto value = extras.number("radius_m", 0, most_radius)) out.radius_m = static_cast<float>(*value);
  if (const auto value = extras.text("group")) out.group = *value;
  if (const auto value = extras.number("power_w", 0, most_power)) out.power_w = static_cast<float>(*value);
  if (const auto value = range_in(extras, "range_m")) {
    out.range_m = *value > 0 ? std::optional(static_cast<float>(*value)) : std::nullopt;
    if (*value == 0) warn_of_range(gltf, out, here, warnings);
  }
}

/// Turns the light to its node's -Z. False where the node has no direction and the light needs one.
bool aim(const PlacedNode& placed, Light& light) {
  const glm::dvec3 direction = world_direction(placed.world_from_local, {0, 0, -1});
  if (direction == glm::dvec3(0)) return light.type == LightType::point;  // a point light needs none
  light.direction_ws = glm::vec3(direction);
  return true;
}

}  // namespace

void add_light(const Gltf& gltf, const PlacedNode& placed, std::set<size_t>& seen, Scene& scene, Warnings& warnings) {
  const tinygltf::Node& node = gltf.model.nodes[placed.node];
  const auto extension = node.extensions.find("KHR_lights_punctual");
  if (extension == node.extensions.end() || !extension->second.Has("light")) return;
  const auto number = static_cast<size_t>(extension->second.Get("light").GetNumberAsInt());
  const tinygltf::Light& in = gltf.model.lights[number];
  const Json& lights = gltf.json["extensions"]["KHR_lights_punctual"];
  const std::string here = place(gltf.json, "nodes", placed.node);
  Light out;
  out.name = name_of(node, in.name);
  out.where = gltf.file + ": " + here;
  out.intensity = static_cast<float>(in.intensity);
  for (int c = 0; c < 3 && !in.color.empty(); ++c) out.color[c] = static_cast<float>(in.color[c]);
  if (in.type == "spot") out.type = LightType::spot;
  if (in.type == "directional") out.type = LightType::directional;
  if (in.range > 0) out.range_m = static_cast<float>(in.range);
  const std::string of_light = place(lights, "lights", number);
  Warnings said_before;
  Warnings& once = seen.insert(number).second ? warnings : said_before;  // not again for each node with the light
  if (lights["lights"][number].value("range", 1.0) == 0) warn_of_range(gltf, out, of_light, once);
  read_extras(gltf, lights["lights"][number], of_light, out, once);
  read_extras(gltf, gltf.json["nodes"][placed.node], here, out, warnings);
  if (out.intensity == 0 || std::max({out.color.r, out.color.g, out.color.b}) == 0) {
    warnings.add(gltf.file, here, "a light without intensity or colour is skipped");
    return;
  }
  if (std::max({out.color.r, out.color.g, out.color.b}) > 1) {
    once.add(gltf.file, of_light, "a light's colour is above 1, where glTF's end: it is that much brighter");
  }
  if (!aim(placed, out)) {
    warnings.add(gltf.file, here, "a light whose node has zero scale has no direction and is skipped");
    return;
  }
  if (out.type == LightType::directional) {
    out.range_m.reset();
  } else {
    out.position_ws = glm::dvec3(placed.world_from_local[3]);
  }
  out.inner_cone_rad = static_cast<float>(in.spot.innerConeAngle);
  out.outer_cone_rad = static_cast<float>(in.spot.outerConeAngle);
  scene.lights.push_back(std::move(out));
}

}  // namespace chandelier::baker
