// SPDX-License-Identifier: Apache-2.0
// Everything is in doubles until it has its new origin: a float holds 1.5 km to 0.1 mm, 500 km only to 3 cm.
#include "recentre.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "quantize.h"
#include "scene_origin.h"

namespace chandelier::baker {
namespace {

constexpr double coarse_m = 1e-3;  // a warning is given where adjacent floats are further apart than this

struct Box {
  glm::dvec3 low{INFINITY}, high{-INFINITY};

  void include(const glm::dvec3& p) {
    low = glm::min(low, p);
    high = glm::max(high, p);
  }
  bool is_empty() const { return !(low.x <= high.x); }
  glm::dvec3 corner(int i) const { return {i & 1 ? high.x : low.x, i & 2 ? high.y : low.y, i & 4 ? high.z : low.z}; }
  double longest_side() const { return std::max({high.x - low.x, high.y - low.y, high.z - low.z}); }
  double farthest() const {
    const glm::dvec3 most = glm::max(glm::abs(low), glm::abs(high));
    return std::max({most.x, most.y, most.z});
  }
};

Box box_of(const Mesh& mesh) {
  Box box;
  for (const Primitive& primitive : mesh.primitives) {
    for (const Vertex& vertex : primitive.vertices) box.include(glm::dvec3(vertex.position_ls));
  }
  return box;
}

/// How far apart floats are around a number.
double spacing(double value) {
  const auto nearest = std::abs(static_cast<float>(value));
  return double{std::nextafter(nearest, INFINITY)} - double{nearest};
}

bool is_float(double value) {
  return double{static_cast<float>(value)} == value;
}

bool is_far(const glm::dvec3& place) {
  return std::max({spacing(place.x), spacing(place.y), spacing(place.z)}) > coarse_m;
}

/// Whether a far position is exactly a float in each coordinate where floats are coarse.
bool is_of_floats(const glm::dvec3& place) {
  for (int axis = 0; axis < 3; ++axis) {
    if (spacing(place[axis]) > coarse_m && !is_float(place[axis])) return false;
  }
  return true;
}

/// Whether most far positions are exactly floats: then they have been rounded. In a scene that was placed far away as a
/// whole, most are not; in a scene that was rounded node by node, all are, except below other nodes.
bool are_rounded(const std::vector<glm::dvec3>& places) {
  const auto far = std::ranges::count_if(places, is_far);
  const auto floats =
      std::ranges::count_if(places, [](const glm::dvec3& place) { return is_far(place) && is_of_floats(place); });
  return 2 * floats > far;
}

/// A position in whole millimetres may be intended or rounded; it counts as intended.
bool is_coarse(const glm::dvec3& place) {
  if (!is_of_floats(place)) return false;
  for (int axis = 0; axis < 3; ++axis) {
    const double mm = 1000 * place[axis];
    if (spacing(place[axis]) > coarse_m && std::abs(mm - std::nearbyint(mm)) > 1e-3) return true;
  }
  return false;
}

glm::dmat4 moved(const glm::dvec3& by) {
  glm::dmat4 out(1);
  out[3] = glm::dvec4(by, 1);
  return out;
}

/// Warns of positions that the files' floats hold only coarsely. `boxes`: of each mesh in its file's coordinates.
void warn_of_rounding(const Scene& scene, const std::vector<Box>& boxes, Warnings& warnings) {
  std::vector<glm::dvec3> places;
  for (const MeshInstance& instance : scene.instances) places.emplace_back(instance.world_from_local[3]);
  for (const Light& light : scene.lights) places.push_back(light.position_ws);
  const bool rounded = are_rounded(places);
  double coarsest_m = 0;
  std::vector<std::string> names;
  const auto note = [&](const std::string& name, const std::string& where, double apart_m) {
    coarsest_m = std::max(coarsest_m, apart_m);
    names.push_back(name.empty() ? where : name);
  };
  const auto apart = [](const glm::dvec3& p) { return std::max({spacing(p.x), spacing(p.y), spacing(p.z)}); };
  for (const MeshInstance& instance : scene.instances) {
    const glm::dvec3 place(instance.world_from_local[3]);
    const Box& box = boxes[instance.mesh];
    const double step = box.is_empty() ? 0 : spacing(box.farthest());
    const double step_m = step * largest_scale(instance.world_from_local);
    const bool coarse_mesh = step_m > coarse_m && step > 1e-4 * box.longest_side();
    if (coarse_mesh || (rounded && is_coarse(place)))
      note(instance.name, instance.where, coarse_mesh ? step_m : apart(place));
  }
  for (const Light& light : scene.lights) {
    if (rounded && is_coarse(light.position_ws)) note(light.name, light.where, apart(light.position_ws));
  }
  const std::string what =
      fmt::format("so far from the origin that the file's floats are up to {:.3g} mm apart: the file has rounded them",
                  1000 * coarsest_m);
  for (const std::string& name : names) warnings.add("scene", "positions", what, name);
}

/// Moves meshes whose vertices are far from their own origin, and their instances the opposite way. A mesh that a skin
/// bends stays, since its joints may bend others too. Returns how many were moved.
int recentre_meshes(Scene& scene, const std::vector<Box>& boxes) {
  std::vector<glm::dvec3> origins(scene.meshes.size(), glm::dvec3(0));
  for (size_t m = 0; m < boxes.size(); ++m) {
    if (!boxes[m].is_empty()) origins[m] = pack::scene_origin(boxes[m].low, boxes[m].high);
  }
  for (const MeshInstance& instance : scene.instances) {
    if (instance.skin != no_index) origins[instance.mesh] = glm::dvec3(0);
  }
  int count = 0;
  for (size_t m = 0; m < origins.size(); ++m) {
    if (origins[m] == glm::dvec3(0)) continue;
    ++count;
    for (Primitive& primitive : scene.meshes[m].primitives) {
      for (Vertex& vertex : primitive.vertices) {
        vertex.position_ls = glm::vec3(glm::dvec3(vertex.position_ls) - origins[m]);
      }
    }
  }
  for (MeshInstance& instance : scene.instances) {
    if (origins[instance.mesh] == glm::dvec3(0)) continue;
    instance.world_from_local = instance.world_from_local * moved(origins[instance.mesh]);
  }
  return count;
}

/// The box around all meshes and all lights that have a position.
Box box_of(const Scene& scene, const std::vector<Box>& boxes) {
  Box all;
  for (const MeshInstance& instance : scene.instances) {
    const Box& box = boxes[instance.mesh];
    for (int i = 0; i < 8 && !box.is_empty(); ++i) {
      all.include(glm::dvec3(instance.world_from_local * glm::dvec4(box.corner(i), 1)));
    }
  }
  for (const Light& light : scene.lights) {
    if (light.type != LightType::directional) all.include(light.position_ws);
  }
  return all;
}

/// Nodes without a parent carry all others; where an animation moves one, its keys say where it is.
void move_nodes(Scene& scene, const glm::dvec3& origin) {
  for (Node& node : scene.nodes) {
    if (node.parent != no_index) continue;
    node.parent_from_local = moved(-origin) * node.parent_from_local;
    node.translation -= origin;
  }
  for (Animation& animation : scene.animations) {
    for (AnimationChannel& channel : animation.channels) {
      if (channel.path != AnimationPath::translation || scene.nodes[channel.node].parent != no_index) continue;
      const bool cubic = channel.interpolation == Interpolation::cubic_spline;  // tangent, value, tangent
      for (size_t i = 0; i < channel.values.size(); ++i) {
        if (cubic && i / 3 % 3 != 1) continue;
        channel.values[i] = static_cast<float>(double{channel.values[i]} - origin[static_cast<int>(i % 3)]);
      }
    }
  }
}

void move_world(Scene& scene, const glm::dvec3& origin) {
  const glm::dmat4 back = moved(-origin);
  for (MeshInstance& instance : scene.instances) instance.world_from_local = back * instance.world_from_local;
  for (Light& light : scene.lights) {
    if (light.type != LightType::directional) light.position_ws -= origin;
  }
  for (Camera& camera : scene.cameras) camera.position_ws -= origin;
  move_nodes(scene, origin);
  scene.origin_m += origin;
}

}  // namespace

void recentre(Scene& scene, PassReport& pass, Warnings& warnings) {
  std::vector<Box> boxes;
  for (const Mesh& mesh : scene.meshes) boxes.push_back(box_of(mesh));
  warn_of_rounding(scene, boxes, warnings);
  const Box all = box_of(scene, boxes);
  pass.count("meshes", recentre_meshes(scene, boxes));
  const glm::dvec3 origin = all.is_empty() ? glm::dvec3(0) : pack::scene_origin(all.low, all.high);
  if (origin != glm::dvec3(0)) move_world(scene, origin);
  for (int axis = 0; axis < 3; ++axis) pass.count(std::string("origin_") + "xyz"[axis] + "_m", origin[axis]);
}

}  // namespace chandelier::baker
