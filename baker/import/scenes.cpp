// SPDX-License-Identifier: Apache-2.0
// A name is tried before a number, so that a scene named "2" can be chosen.
#include "scenes.h"

#include <algorithm>
#include <charconv>

#include "json_object.h"

namespace chandelier::baker {
namespace {

constexpr size_t most_listed = 10;

std::optional<size_t> find_scene(const Json& json, const std::string& asked) {
  const size_t count = section_size(json, "scenes");
  for (size_t i = 0; i < count; ++i) {
    if (json["scenes"][i].value("name", "") == asked) return i;
  }
  size_t number = 0;
  const char* end = asked.data() + asked.size();
  const auto [stop, error] = std::from_chars(asked.data(), end, number);
  return error == std::errc() && stop == end && number < count ? std::optional(number) : std::nullopt;
}

[[noreturn]] void fail_unknown(const Gltf& gltf, const std::string& asked) {
  const size_t count = section_size(gltf.json, "scenes");
  std::string names;
  for (size_t i = 0; i < std::min(count, most_listed); ++i) {
    names += (i ? ", " : "") + place(gltf.json, "scenes", i);
  }
  if (count > most_listed) names += " and " + std::to_string(count - most_listed) + " more";
  fail(gltf.file + ": --scene", "there is no such scene; the scenes are " + names + " (" + shortened(asked, 80) + ")");
}

}  // namespace

ChosenScene choose_scene(const Gltf& gltf, const std::string& asked, Warnings& warnings) {
  const size_t count = section_size(gltf.json, "scenes");
  if (count == 0) return {};
  if (!asked.empty()) {
    if (const auto number = find_scene(gltf.json, asked)) return {number, true, count - 1};
    if (count > 1) fail_unknown(gltf, asked);
  }
  const auto number = static_cast<size_t>(std::max(gltf.model.defaultScene, 0));
  for (size_t i = 0; i < count; ++i) {
    if (i == number) continue;
    warnings.add(gltf.file, place(gltf.json, "scenes", number),
                 "is the only scene that is baked; --scene NAME or NUMBER takes another. Left out",
                 place(gltf.json, "scenes", i));
  }
  return {number, false, count - 1};
}

}  // namespace chandelier::baker
