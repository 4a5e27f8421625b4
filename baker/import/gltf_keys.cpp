// SPDX-License-Identifier: Apache-2.0
// The keys of glTF 2.0's objects (its JSON schemas) and of KHR_lights_punctual's. Other extensions and extras are not
// checked.
#include <algorithm>
#include <cctype>
#include <map>
#include <string_view>

#include "gltf_lint.h"

namespace chandelier::baker {
namespace {

/// The keys of an object. Each may lead to an object, or to an array of objects, of a shape of its own.
struct Shape {
  std::map<std::string_view, const Shape*> keys;
};

/// Keys whose values are not objects to check.
Shape plain(std::initializer_list<std::string_view> keys) {
  Shape out;
  for (const std::string_view key : keys) out.keys[key] = nullptr;
  return out;
}

Shape shape(std::initializer_list<std::string_view> keys,
            std::initializer_list<std::pair<std::string_view, const Shape*>> inner) {
  Shape out = plain(keys);
  for (const auto& [key, of] : inner) out.keys[key] = of;
  return out;
}

// The keys are those of the specification's list of objects, unless a comment says otherwise.
const Shape texture_info = plain({"index", "texCoord"});
const Shape normal_texture = plain({"index", "texCoord", "scale"});
const Shape occlusion_texture = plain({"index", "texCoord", "strength"});
const Shape pbr = shape({"baseColorFactor", "metallicFactor", "roughnessFactor"},
                        {{"baseColorTexture", &texture_info}, {"metallicRoughnessTexture", &texture_info}});
const Shape material = shape({"name", "emissiveFactor", "alphaMode", "alphaCutoff", "doubleSided"},
                             {{"pbrMetallicRoughness", &pbr},
                              {"normalTexture", &normal_texture},
                              {"occlusionTexture", &occlusion_texture},
                              {"emissiveTexture", &texture_info}});
const Shape sparse_indices = plain({"bufferView", "byteOffset", "componentType"});
const Shape sparse_values = plain({"bufferView", "byteOffset"});
const Shape sparse = shape({"count"}, {{"indices", &sparse_indices}, {"values", &sparse_values}});
const Shape accessor =
    shape({"name", "bufferView", "byteOffset", "componentType", "normalized", "count", "type", "max", "min"},
          {{"sparse", &sparse}});
const Shape target = plain({"node", "path"});
const Shape channel = shape({"sampler"}, {{"target", &target}});
const Shape animation_sampler = plain({"input", "interpolation", "output"});
const Shape animation = shape({"name"}, {{"channels", &channel}, {"samplers", &animation_sampler}});
const Shape asset = plain({"copyright", "generator", "version", "minVersion"});
const Shape buffer = plain({"name", "uri", "byteLength"});
const Shape buffer_view = plain({"name", "buffer", "byteOffset", "byteLength", "byteStride", "target"});
const Shape orthographic = plain({"xmag", "ymag", "zfar", "znear"});
const Shape perspective = plain({"aspectRatio", "yfov", "zfar", "znear"});
const Shape camera = shape({"name", "type"}, {{"orthographic", &orthographic}, {"perspective", &perspective}});
const Shape image = plain({"name", "uri", "mimeType", "bufferView"});
const Shape primitive = plain({"attributes", "indices", "material", "mode", "targets"});
const Shape mesh = shape({"name", "weights"}, {{"primitives", &primitive}});
const Shape node =
    plain({"name", "camera", "children", "skin", "matrix", "mesh", "rotation", "scale", "translation", "weights"});
const Shape sampler = plain({"name", "magFilter", "minFilter", "wrapS", "wrapT"});
const Shape scene = plain({"name", "nodes"});
const Shape skin = plain({"name", "inverseBindMatrices", "skeleton", "joints"});
const Shape texture = plain({"name", "sampler", "source"});
const Shape spot = plain({"innerConeAngle", "outerConeAngle"});
const Shape light = shape({"name", "color", "intensity", "type", "range"}, {{"spot", &spot}});

struct Section {
  const char* name;
  const Shape& of;
};
const Section sections[] = {{"accessors", accessor},      {"animations", animation}, {"buffers", buffer},
                            {"bufferViews", buffer_view}, {"cameras", camera},       {"images", image},
                            {"materials", material},      {"meshes", mesh},          {"nodes", node},
                            {"samplers", sampler},        {"scenes", scene},         {"skins", skin},
                            {"textures", texture}};

Shape root_shape() {
  Shape out = shape({"extensionsUsed", "extensionsRequired", "scene"}, {{"asset", &asset}});
  for (const Section& section : sections) out.keys[section.name] = nullptr;
  return out;
}
const Shape root = root_shape();

/// Characters to add, drop or replace (Levenshtein), whatever their case. At most 40 characters each.
size_t distance(std::string_view a, std::string_view b) {
  const auto lower = [](char c) { return std::tolower(static_cast<unsigned char>(c)); };
  std::vector<size_t> row(b.size() + 1);
  for (size_t j = 0; j <= b.size(); ++j) row[j] = j;
  for (size_t i = 1; i <= a.size(); ++i) {
    size_t diagonal = row[0];
    row[0] = i;
    for (size_t j = 1; j <= b.size(); ++j) {
      const size_t replaced = diagonal + (lower(a[i - 1]) != lower(b[j - 1]));
      diagonal = row[j];
      row[j] = std::min({replaced, row[j] + 1, row[j - 1] + 1});
    }
  }
  return row[b.size()];
}

/// The nearest known key, if it is near enough to be a likely correction; else empty.
std::string_view nearest(std::string_view key, const Shape& shape) {
  if (key.size() > 40) return {};
  std::string_view best;
  size_t least = std::max<size_t>(2, key.size() / 3) + 1;  // one above the largest number of changed letters
  for (const auto& [known, of] : shape.keys) {
    const size_t far = distance(key, known);
    if (far < least && far < known.size()) least = far, best = known;
  }
  return best;
}

struct KeyLint {
  const Lint& lint;
  uint64_t unknown_keys = 0;

  /// `place`: of the object, or of the one that it is in; empty for the glTF's own.
  void unknown(const std::string& place, std::string_view key, const Shape& shape) {
    constexpr uint64_t most_corrected = 3;  // keys for which a correction is suggested
    std::string name = (place.empty() ? "" : place + ": ") + shortened(std::string(key), 40);
    const std::string_view meant = unknown_keys++ < most_corrected ? nearest(key, shape) : std::string_view();
    if (!meant.empty()) name += ", is it " + std::string(meant) + "?";
    lint.warnings.add(lint.file, "glTF", "unknown key is ignored", key.empty() ? "an empty name" : name);
  }

  template <typename Place>
  void walk(const Json& value, const Shape& shape, const Place& place) {
    if (value.is_array()) {
      for (const Json& each : value) walk(each, shape, place);
    }
    if (!value.is_object()) return;
    for (const auto& [key, inner] : value.items()) {
      if (key == "extensions" || key == "extras") continue;
      const auto known = shape.keys.find(key);
      if (known == shape.keys.end()) {
        unknown(place(), key, shape);
      } else if (known->second) {
        walk(inner, *known->second, place);
      }
    }
  }
};

}  // namespace

void lint_keys(const Lint& lint) {
  KeyLint keys{lint};
  keys.walk(lint.json, root, [] { return std::string(); });
  for (const auto& [name, of] : sections) {
    for (size_t i = 0; i < section_size(lint.json, name); ++i) {
      keys.walk(lint.entry(name, i), of, [&] { return place(lint.json, name, i); });
    }
  }
  const auto lights = lint.json.find("extensions");
  if (lights == lint.json.end() || !lights->contains("KHR_lights_punctual")) return;
  const Json& punctual = (*lights)["KHR_lights_punctual"];
  for (size_t i = 0; i < section_size(punctual, "lights"); ++i) {
    keys.walk(punctual["lights"][i], light, [&] { return place(punctual, "lights", i); });
  }
}

}  // namespace chandelier::baker
