// SPDX-License-Identifier: Apache-2.0
// The rules between fields of lights and their hierarchy.
#include "pack_checks_lights.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "pack_checks_text.h"

namespace chandelier::pack {
namespace {

/// The bounds must contain the light itself, where the volume that it lights begins; only rounding may put it outside.
bool holds_its_light(const Light& light) {
  double distance2 = 0, most = std::abs(double{light.bounds_radius_m});
  for (int axis = 0; axis < 3; ++axis) {
    const double apart = double{light.position_ws[axis]} - double{light.bounds_center_ws[axis]};
    distance2 += apart * apart;
    most = std::max(most, std::abs(double{light.position_ws[axis]}));
  }
  return std::sqrt(distance2) <= double{light.bounds_radius_m} + 1e-5 * most;
}

std::string bounds_fault(const View& view) {
  for (size_t i = 0; i < view.lights.size(); ++i) {
    const Light& light = view.lights[i];
    if (light.type != LightType::directional) {
      if (!holds_its_light(light)) return at("lights", i) + ".bounds_center_ws: the light is not in its bounds";
    } else if (light.voxel != none) {
      return at("lights", i) + ".voxel: a directional light has none";
    }
  }
  return {};
}

/// Numbered from 1, in the order of the first light of each.
std::string group_fault(const View& view) {
  uint32_t groups = 0;
  for (size_t i = 0; i < view.lights.size(); ++i) {
    const uint32_t group = view.lights[i].group;
    if (group > groups + 1) {
      return at("lights", i) + ".group: " + std::to_string(group) + " comes after " + std::to_string(groups) +
             " groups";
    }
    groups = std::max(groups, group);
  }
  return {};
}

/// A traversal goes on with the next node or with `miss`, so it ends if `miss` is always ahead. Every node ends within
/// the one that it is in; each point and spot light has one leaf.
std::string bvh_fault(const View& view) {
  const size_t count = view.light_bvh.size();
  std::vector<bool> seen(view.lights.size(), false);
  std::vector<size_t> ends = {count};  // of the nodes that this one is in
  size_t leaves = 0;
  for (size_t i = 0; i < count; ++i) {
    const LightBvhNode& node = view.light_bvh[i];
    while (ends.size() > 1 && ends.back() == i) ends.pop_back();
    const bool is_leaf = node.light != none;
    const size_t least = is_leaf ? i + 1 : i + 2, most = is_leaf ? i + 1 : ends.back();
    if (node.miss < least || node.miss > most) {
      return at("light_bvh", i) + ".miss: " + std::to_string(node.miss) + " is not from " + std::to_string(least) +
             " to " + std::to_string(most);
    }
    if (!is_leaf) {
      ends.push_back(node.miss);
      continue;
    }
    ++leaves;
    if (view.lights[node.light].type == LightType::directional) {
      return at("light_bvh", i) + ".light: " + std::to_string(node.light) + " is a directional light";
    }
    if (seen[node.light]) return at("light_bvh", i) + ".light: " + std::to_string(node.light) + " has a leaf already";
    seen[node.light] = true;
  }
  const auto directional = std::count_if(view.lights.begin(), view.lights.end(),
                                         [](const Light& light) { return light.type == LightType::directional; });
  const size_t placed = view.lights.size() - static_cast<size_t>(directional);
  if (count == 0 || leaves == placed) return {};
  return "light_bvh: " + std::to_string(leaves) + " leaves for " + std::to_string(placed) + " point and spot lights";
}

}  // namespace

std::string light_fault(const View& view) {
  if (std::string line = bounds_fault(view); !line.empty()) return line;
  if (std::string line = group_fault(view); !line.empty()) return line;
  return bvh_fault(view);
}

}  // namespace chandelier::pack
