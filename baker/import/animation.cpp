// SPDX-License-Identifier: Apache-2.0
// Samplers: times ascend, the number of values suits that of the times, rotations are unit quaternions.
#include "animation.h"

#include <cmath>
#include <optional>

#include "accessor.h"

namespace chandelier::baker {
namespace {

constexpr uint64_t most_values = 1ull << 28;  // of all animations: channels can share one accessor

std::vector<float> read_times(const Gltf& gltf, int accessor, const std::string& where) {
  if (gltf.model.accessors[static_cast<size_t>(accessor)].componentType != TINYGLTF_COMPONENT_TYPE_FLOAT) {
    fail(where, "component type is not float");
  }
  std::vector<float> times = read_floats(gltf, accessor, 1, 1, where).values;
  if (times.empty()) fail(where, "has no keys");
  if (times[0] < 0) fail(where, "a key has a negative time (" + to_text(times[0]) + " s)");
  for (size_t i = 1; i < times.size(); ++i) {
    if (times[i] > times[i - 1]) continue;
    fail(where, "times do not ascend (" + to_text(times[i]) + " s at key " + std::to_string(i) + ")");
  }
  return times;
}

bool may_hold(AnimationPath path, const tinygltf::Accessor& accessor) {
  if (accessor.componentType == TINYGLTF_COMPONENT_TYPE_FLOAT) return true;
  return path == AnimationPath::rotation && accessor.normalized &&
         accessor.componentType != TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT;
}

/// Makes quaternions unit length. Returns whether one was off by more than rounding.
bool normalize_rotations(AnimationChannel& channel, const std::string& where) {
  constexpr double rounding = 0.01;  // 8-bit components
  const bool cubic = channel.interpolation == Interpolation::cubic_spline;
  bool off = false;
  for (size_t key = 0; key < channel.times_s.size(); ++key) {
    float* q = channel.values.data() + (cubic ? 12 * key + 4 : 4 * key);  // the value between its tangents
    const double length =
        std::sqrt(double{q[0]} * q[0] + double{q[1]} * q[1] + double{q[2]} * q[2] + double{q[3]} * q[3]);
    if (!(length > 1e-6)) fail(where, "rotation has no direction (key " + std::to_string(key) + ")");
    off = off || std::abs(length - 1) > rounding;
    for (int c = 0; c < 4; ++c) q[c] = static_cast<float>(q[c] / length);
  }
  return off;
}

Interpolation interpolation_of(const Json& sampler) {
  const std::string name = sampler.value("interpolation", "LINEAR");
  if (name == "CUBICSPLINE") return Interpolation::cubic_spline;
  return name == "STEP" ? Interpolation::step : Interpolation::linear;
}

AnimationChannel read_channel(const Gltf& gltf, const Json& sampler, AnimationPath path, const std::string& here,
                              Warnings& warnings) {
  const std::string where = gltf.file + ": " + here;
  AnimationChannel out;
  out.path = path;
  out.interpolation = interpolation_of(sampler);
  out.times_s = read_times(gltf, sampler["input"].get<int>(), where + ", input");
  const bool cubic = out.interpolation == Interpolation::cubic_spline;
  if (cubic && out.times_s.size() < 2) fail(where + ", input", "a cubic spline has fewer than two keys (1)");
  const auto output = sampler["output"].get<int>();
  if (!may_hold(path, gltf.model.accessors[static_cast<size_t>(output)])) {
    fail(where + ", output", "component type is not allowed for this path");
  }
  const size_t components = path == AnimationPath::rotation ? 4 : 3;
  Floats values = read_floats(gltf, output, components, components, where + ", output");
  const size_t expected = out.times_s.size() * (cubic ? 3 : 1);
  if (values.count != expected) {
    fail(where + ", output", "has a different number of values than its keys need, " + std::to_string(expected) + " (" +
                                 std::to_string(values.count) + ")");
  }
  out.values = std::move(values.values);
  if (path == AnimationPath::rotation && normalize_rotations(out, where + ", output")) {
    warnings.add(gltf.file, here, "rotations that are not of unit length are normalized");
  }
  return out;
}

/// Whether its keys have no data: an accessor without a buffer view is all zeros.
bool lacks_data(const Gltf& gltf, const Json& sampler) {
  const auto lacks = [&](const char* key) {
    const tinygltf::Accessor& accessor = gltf.model.accessors[sampler[key].get<size_t>()];
    return accessor.bufferView < 0 && !accessor.sparse.isSparse;
  };
  return lacks("input") || lacks("output");
}

/// Nothing for a path that the pack cannot hold.
std::optional<AnimationPath> path_of(const std::string& name) {
  if (name == "translation") return AnimationPath::translation;
  if (name == "rotation") return AnimationPath::rotation;
  if (name == "scale") return AnimationPath::scale;
  return std::nullopt;
}

/// What KHR_animation_pointer says that a channel changes.
std::string pointer_of(const Json& target) {
  static const Json::json_pointer pointer("/extensions/KHR_animation_pointer/pointer");
  return target.value(pointer, "pointer");
}

Animation read_animation(const Gltf& gltf, const Json& json, const std::string& here,
                         const std::vector<uint8_t>& in_scene, uint64_t& values, Warnings& warnings) {
  Animation out;
  out.name = json.value("name", "");
  for (const Json& channel : json["channels"]) {
    const Json& target = channel["target"];
    const std::string name = target["path"].get<std::string>();
    const auto path = path_of(name);
    if (name == "pointer") {
      warnings.add(gltf.file, here,
                   "animation by KHR_animation_pointer is skipped: the properties that it changes stay as they are",
                   pointer_of(target));
      continue;
    }
    if (!path) warnings.add(gltf.file, here, "animation of something other than a node's transform is skipped", name);
    if (!target.contains("node")) warnings.add(gltf.file, here, "a channel without a node is skipped");
    if (!path || !target.contains("node")) continue;
    const auto node = target["node"].get<uint32_t>();
    if (!in_scene[node]) continue;
    const auto sampler = channel["sampler"].get<size_t>();
    if (lacks_data(gltf, json["samplers"][sampler])) {
      warnings.add(gltf.file, here, "a channel whose keys have no data is skipped");
      continue;
    }
    out.channels.push_back(
        read_channel(gltf, json["samplers"][sampler], *path, here + ", sampler " + std::to_string(sampler), warnings));
    out.channels.back().node = node;
    values += out.channels.back().values.size() + out.channels.back().times_s.size();
    if (values > most_values) {
      fail(gltf.file + ": " + here, "the animations up to here have more than " + std::to_string(most_values) +
                                        " values (" + std::to_string(values) + ")");
    }
  }
  return out;
}

}  // namespace

std::vector<Animation> read_animations(const Gltf& gltf, const std::vector<uint8_t>& in_scene, Warnings& warnings) {
  std::vector<Animation> out;
  uint64_t values = 0;
  const auto animations = gltf.json.find("animations");
  for (size_t i = 0; animations != gltf.json.end() && i < animations->size(); ++i) {
    Animation animation =
        read_animation(gltf, (*animations)[i], place(gltf.json, "animations", i), in_scene, values, warnings);
    if (!animation.channels.empty()) out.push_back(std::move(animation));
  }
  return out;
}

}  // namespace chandelier::baker
