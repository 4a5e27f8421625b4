// SPDX-License-Identifier: Apache-2.0
// Checks the JSON of animations and skins.
#include <set>

#include "gltf_check.h"

namespace chandelier::baker {
namespace {

void check_channel(const Json& root, const Object& animation, const Object& channel,
                   std::set<std::pair<uint64_t, std::string>>& targets) {
  channel.index("sampler", section_size(animation.json, "samplers"), Need::required);
  const auto target = channel.object("target", Need::required);
  target->index("node", section_size(root, "nodes"));
  target->text("path", Need::required);
  if (const auto pointer = target->extension("KHR_animation_pointer")) pointer->text("pointer");
  const auto& path = target->json["path"].get_ref<const std::string&>();
  if (!target->json.contains("node")) return;
  const auto node = target->json["node"].get<uint64_t>();
  if (!targets.emplace(node, path).second) target->bad("path", "is animated twice", path);
  const bool moves = path == "translation" || path == "rotation" || path == "scale";
  if (moves && root["nodes"][node].contains("matrix")) target->bad("node", "is animated but has a matrix", node);
}

}  // namespace

void check_animation(const Json& root, const Object& animation) {
  const size_t accessors = section_size(root, "accessors");
  for (const Object& sampler : animation.objects("samplers", Need::required)) {
    sampler.index("input", accessors, Need::required);
    sampler.index("output", accessors, Need::required);
    sampler.text("interpolation");
    const std::string interpolation = sampler.json.value("interpolation", "LINEAR");
    if (interpolation != "LINEAR" && interpolation != "STEP" && interpolation != "CUBICSPLINE") {
      sampler.bad("interpolation", "is not LINEAR, STEP or CUBICSPLINE", interpolation);
    }
  }
  std::set<std::pair<uint64_t, std::string>> targets;
  for (const Object& channel : animation.objects("channels", Need::required)) {
    check_channel(root, animation, channel, targets);
  }
}

void check_skin(const Json& root, const Object& skin) {
  const size_t nodes = section_size(root, "nodes");
  skin.index("skeleton", nodes);
  skin.index("inverseBindMatrices", section_size(root, "accessors"));
  skin.indices("joints", nodes, Need::required);
  const Json& joints = skin.json["joints"];
  if (joints.empty() || joints.size() > 65535) {
    fail(skin.where + ", joints", "are not 1 to 65535 (" + std::to_string(joints.size()) + ")");
  }
  std::set<uint64_t> seen;
  for (const Json& joint : joints) {
    if (!seen.insert(joint.get<uint64_t>()).second) skin.bad("joints", "names a node twice", joint);
  }
}

}  // namespace chandelier::baker
