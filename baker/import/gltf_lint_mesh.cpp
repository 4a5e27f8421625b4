// SPDX-License-Identifier: Apache-2.0
// Meshes, drawn or not: attributes, indices, morph targets.
#include <algorithm>
#include <set>

#include "gltf_lint.h"

namespace chandelier::baker {
namespace {

constexpr uint64_t vertex_target = 34962, index_target = 34963;  // a buffer view's target

bool is_known_attribute(const std::string& name) {
  if (name == "POSITION" || name == "NORMAL" || name == "TANGENT" || name[0] == '_') return true;
  const size_t line = name.rfind('_');
  if (line == std::string::npos || line + 1 == name.size()) return false;
  static const std::set<std::string> sets = {"TEXCOORD", "COLOR", "JOINTS", "WEIGHTS"};
  const std::string digits = name.substr(line + 1);
  return sets.contains(name.substr(0, line)) && digits.find_first_not_of("0123456789") == std::string::npos &&
         (digits == "0" || digits[0] != '0');
}

/// Whether the sets of an attribute are numbered without gaps.
bool is_numbered_on(const std::string& name, const Json& attributes) {
  const size_t line = name.rfind('_');
  if (name[0] == '_' || line == std::string::npos || line + 1 == name.size()) return true;
  const std::string digits = name.substr(line + 1);
  if (digits.size() > 4 || digits.find_first_not_of("0123456789") != std::string::npos || digits == "0") return true;
  return attributes.contains(name.substr(0, line + 1) + std::to_string(std::stoi(digits) - 1));
}

struct MeshLint {
  const Lint& lint;
  size_t mesh;
  void warn(const std::string& what) const { lint.warn("meshes", mesh, what); }

  void attribute(const std::string& name, const Json& accessor, bool quantized) const {
    const Json& view = lint.view_of(accessor);
    const uint64_t type = whole(accessor, "componentType", 0);
    if (!is_known_attribute(name)) warn("attribute '" + shortened(name, 40) + "' is unknown");
    if (type == 5125) warn("an attribute is of 32-bit integers");
    if (name == "POSITION" && !(accessor.contains("min") && accessor.contains("max"))) warn("POSITION has no bounds");
    const bool floats = type == 5126 && accessor["type"] == "VEC3" && !accessor.value("normalized", false);
    if ((name == "POSITION" || name == "NORMAL") && !quantized && !floats)
      warn("POSITION or NORMAL is not of three floats");
    if (whole(accessor, "byteOffset", 0) % 4 != 0 || element_bytes(accessor) % 4 != 0) {
      if (whole(view, "byteStride", element_bytes(accessor)) % 4 != 0 || whole(accessor, "byteOffset", 0) % 4 != 0) {
        warn("an attribute is not aligned to 4 bytes");
      }
    }
    if (whole(view, "target", vertex_target) != vertex_target)
      warn("the target of an attribute's buffer view is not that of vertices");
  }

  void indices(const Json& accessor) const {
    const uint64_t type = whole(accessor, "componentType", 0);
    const bool right = accessor["type"] == "SCALAR" && (type == 5121 || type == 5123 || type == 5125);
    if (!right || accessor.value("normalized", false)) warn("indices are not of unsigned integers");
    if (lint.view_of(accessor).contains("byteStride")) warn("indices have a byteStride");
    if (whole(lint.view_of(accessor), "target", index_target) != index_target)
      warn("the target of the indices' buffer view is not that of indices");
  }

  /// Checks one morph target. If it has a weight, the importer reads it later and may refuse it.
  void target(const Json& target, const Json& attributes) const {
    for (const auto& [name, value] : target.items()) {
      const Json& accessor = lint.entry("accessors", value.get<size_t>());
      if (!is_known_attribute(name)) warn("a morph target has an unknown attribute");
      if (!attributes.contains(name)) {
        warn("a morph target has an attribute that its base lacks");
      } else if (accessor["count"] != lint.entry("accessors", attributes[name].get<size_t>())["count"]) {
        warn("a morph target has a different number of elements than its base");
      }
      if (name == "POSITION" && !(accessor.contains("min") && accessor.contains("max"))) warn("POSITION has no bounds");
      if (whole(lint.view_of(accessor), "target", vertex_target) != vertex_target) {
        warn("the target of an attribute's buffer view is not that of vertices");
      }
    }
  }

  void primitive(const Json& primitive, bool quantized, std::vector<uint64_t>& shared) const {
    const Json& attributes = primitive["attributes"];
    std::set<uint64_t> counts;
    if (attributes.empty()) warn("a primitive has no attributes");
    for (const auto& [name, value] : attributes.items()) {
      const Json& accessor = lint.entry("accessors", value.get<size_t>());
      counts.insert(whole(accessor, "count", 0));
      attribute(name, accessor, quantized);
      if (!is_numbered_on(name, attributes)) warn("an attribute's sets are not numbered from 0 without gaps");
      const bool joints = name.rfind("JOINTS_", 0) == 0;
      if (joints && !attributes.contains("WEIGHTS_" + name.substr(7))) warn("JOINTS come without WEIGHTS");
      if (name.rfind("WEIGHTS_", 0) == 0 && !attributes.contains("JOINTS_" + name.substr(8))) {
        warn("WEIGHTS come without JOINTS");
      }
      if (accessor.contains("bufferView"))
        shared.push_back(whole(accessor, "bufferView", 0) << 32 | value.get<uint64_t>());
    }
    if (counts.size() > 1) warn("a primitive's attributes have different counts");
    if (primitive.contains("indices")) indices(lint.entry("accessors", primitive["indices"].get<size_t>()));
    if (!primitive.contains("targets") || !primitive["targets"].is_array()) return;
    for (const Json& each : primitive["targets"]) target(each, attributes);
  }
};

/// Accessors of vertices in one view need its stride. `shared`: buffer view and accessor, of each attribute.
void lint_strides(const Lint& lint, std::vector<uint64_t>& shared) {
  std::sort(shared.begin(), shared.end());
  shared.erase(std::unique(shared.begin(), shared.end()), shared.end());
  for (size_t i = 1; i < shared.size(); ++i) {
    const uint64_t view = shared[i] >> 32;
    if (view != shared[i - 1] >> 32 || lint.entry("bufferViews", view).contains("byteStride")) continue;
    lint.warn("bufferViews", view, "it has several attributes and no byteStride");
  }
}

}  // namespace

void lint_meshes(const Lint& lint) {
  std::vector<uint64_t> shared;
  const auto used = lint.json.find("extensionsUsed");
  const bool quantized =
      used != lint.json.end() && std::find(used->begin(), used->end(), "KHR_mesh_quantization") != used->end();
  for (size_t m = 0; m < section_size(lint.json, "meshes"); ++m) {
    const Json& mesh = lint.entry("meshes", m);
    const MeshLint each{lint, m};
    std::set<size_t> target_counts;
    for (const Json& primitive : mesh["primitives"]) {
      each.primitive(primitive, quantized, shared);
      target_counts.insert(section_size(primitive, "targets"));
    }
    if (target_counts.size() > 1) each.warn("its primitives have different numbers of morph targets");
    const bool weights = mesh.contains("weights") && mesh["weights"].is_array();
    if (weights && !target_counts.contains(mesh["weights"].size()))
      each.warn("its weights are not one per morph target");
  }
  lint_strides(lint, shared);
}

}  // namespace chandelier::baker
