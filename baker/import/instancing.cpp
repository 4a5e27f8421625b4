// SPDX-License-Identifier: Apache-2.0
// Attributes of instances: any of TRANSLATION, ROTATION and SCALE, one element per instance.
#include "instancing.h"

#include <algorithm>
#include <glm/gtc/quaternion.hpp>

#include "accessor.h"

namespace chandelier::baker {
namespace {

Floats read_attribute(const Gltf& gltf, const Json& attributes, const char* name, size_t components,
                      const std::string& where) {
  if (!attributes.contains(name)) return {};
  return read_floats(gltf, attributes[name].get<int>(), components, components, where + ", " + name);
}

glm::dmat4 rotation_at(const Floats& rotations, size_t i, const std::string& where) {
  const float* q = rotations.values.data() + 4 * i;
  const glm::dquat rotation(q[3], q[0], q[1], q[2]);  // glm: w first
  const double length = glm::length(rotation);
  if (!(length > 1e-12)) fail(where + ", ROTATION", "has no direction (element " + std::to_string(i) + ")");
  return glm::mat4_cast(rotation / length);
}

}  // namespace

std::optional<std::vector<glm::dmat4>> read_instances(const Gltf& gltf, size_t node) {
  static const Json::json_pointer pointer("/extensions/EXT_mesh_gpu_instancing/attributes");
  const Json& json = gltf.json["nodes"][node];
  if (!json.contains(pointer)) return std::nullopt;
  const Json& attributes = json[pointer];
  const std::string where = gltf.file + ": " + place(gltf.json, "nodes", node) + ", EXT_mesh_gpu_instancing";
  const Floats translations = read_attribute(gltf, attributes, "TRANSLATION", 3, where);
  const Floats rotations = read_attribute(gltf, attributes, "ROTATION", 4, where);
  const Floats scales = read_attribute(gltf, attributes, "SCALE", 3, where);
  if (translations.components + rotations.components + scales.components == 0) return std::nullopt;
  const size_t count = std::max({translations.count, rotations.count, scales.count});
  for (const Floats* each : {&translations, &rotations, &scales}) {
    if (each->components != 0 && each->count != count) {
      fail(where, "its attributes have different counts (" + std::to_string(each->count) + " and " +
                      std::to_string(count) + ")");
    }
  }
  std::vector<glm::dmat4> out(count, glm::dmat4(1));
  for (size_t i = 0; i < count; ++i) {
    if (rotations.count) out[i] = rotation_at(rotations, i, where);
    for (int c = 0; c < 3 && scales.count; ++c) out[i][c] *= scales.values[3 * i + static_cast<size_t>(c)];
    for (int c = 0; c < 3 && translations.count; ++c) {
      out[i][3][c] = translations.values[3 * i + static_cast<size_t>(c)];
    }
  }
  return out;
}

}  // namespace chandelier::baker
