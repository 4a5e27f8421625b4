// SPDX-License-Identifier: Apache-2.0
// glTF 2.0, 3.7.2.2: base + sum of weight · delta, of positions, normals and the directions of tangents. Target after
// target, so that the deltas of only one are in memory.
#include "morph.h"

#include <algorithm>
#include <cmath>

namespace chandelier::baker {
namespace {

constexpr uint64_t most_morphed = 1ull << 30;  // few bytes of a file can ask for any number of targets

/// Calls `add(vertex, weight · delta)` for each vertex.
template <typename Add>
void apply(const VertexSource& source, size_t target, const char* name, std::vector<Vertex>& vertices, Add add) {
  const auto& attributes = source.primitive.targets[target];
  const auto it = attributes.find(name);
  if (it == attributes.end()) return;
  const std::string where = source.where + ", morph target " + std::to_string(target) + ", " + name;
  const Elements deltas = elements_of(source.gltf, it->second, 3, 3, where);
  if (deltas.count != source.vertex_count) {
    fail(where, "has a different number of elements than POSITION, which has " + std::to_string(source.vertex_count) +
                    " (" + std::to_string(deltas.count) + ")");
  }
  const double weight = source.morph_weights[target];
  FirstFault not_finite;
  for_blocks(vertices.size(), [&](size_t first, size_t count) {
    std::array<float, 3 * 1024> values;
    const size_t bad = to_floats(deltas, first, count, values.data());
    if (bad != SIZE_MAX) return not_finite.note(bad);
    for (size_t i = 0; i < count; ++i) {
      add(vertices[first + i], weight * glm::dvec3(values[3 * i], values[3 * i + 1], values[3 * i + 2]));
    }
  });
  if (not_finite.at() != SIZE_MAX) fail_not_finite(deltas, not_finite.at(), where);
}

glm::vec3 moved(const glm::vec3& base, const glm::dvec3& delta) {
  return glm::vec3(glm::dvec3(base) + delta);
}

bool is_finite(const glm::vec3& v) {
  return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

}  // namespace

uint32_t MorphWeights::number_of(const Json& owner) {
  auto weights = owner.value("weights", std::vector<double>());
  const bool any = std::any_of(weights.begin(), weights.end(), [](double weight) { return weight != 0; });
  if (!any) weights.clear();
  const auto [it, added] = numbers_.try_emplace(std::move(weights), static_cast<uint32_t>(by_number_.size()));
  if (added) by_number_.push_back(&it->first);
  return it->second;
}

uint32_t MorphWeights::of_node(size_t number) {
  const Json& node = gltf_.json["nodes"][number];
  if (node.contains("weights")) return number_of(node);
  const auto mesh = node["mesh"].get<size_t>();
  const auto known = of_mesh_.find(mesh);
  if (known != of_mesh_.end()) return known->second;
  return of_mesh_[mesh] = number_of(gltf_.json["meshes"][mesh]);
}

void add_morph_size(const Gltf& gltf, const tinygltf::Primitive& primitive, std::span<const double> weights,
                    const std::string& where, uint64_t& morphed) {
  if (weights.empty()) return;
  if (weights.size() != primitive.targets.size()) {
    fail(where, "has a different number of morph targets than of weights, which are " + std::to_string(weights.size()) +
                    " (" + std::to_string(primitive.targets.size()) + ")");
  }
  for (size_t t = 0; t < weights.size(); ++t) {
    if (weights[t] == 0) continue;
    for (const auto& [name, accessor] : primitive.targets[t]) {
      morphed += checked_accessor(gltf, accessor, where + ", morph target " + std::to_string(t) + ", " + name).count;
    }
  }
  if (morphed > most_morphed) {
    fail(where, "the morph targets up to here have more than " + std::to_string(most_morphed) + " vertices (" +
                    std::to_string(morphed) + ")");
  }
}

bool apply_morphs(const VertexSource& source, Primitive& out) {
  for (size_t t = 0; t < source.morph_weights.size(); ++t) {
    if (source.morph_weights[t] == 0) continue;
    apply(source, t, "POSITION", out.vertices,
          [](Vertex& v, const glm::dvec3& delta) { v.position_ls = moved(v.position_ls, delta); });
    if (!out.needs_normals) {
      apply(source, t, "NORMAL", out.vertices,
            [](Vertex& v, const glm::dvec3& delta) { v.normal_ls = moved(v.normal_ls, delta); });
    }
    if (!out.needs_tangents) {
      apply(source, t, "TANGENT", out.vertices, [](Vertex& v, const glm::dvec3& delta) {
        v.tangent_ls = glm::vec4(moved(glm::vec3(v.tangent_ls), delta), v.tangent_ls.w);
      });
    }
  }
  bool broken = false;
  for (size_t i = 0; i < out.vertices.size(); ++i) {
    Vertex& vertex = out.vertices[i];
    if (!is_finite(vertex.position_ls)) {
      fail(source.where + ", attribute POSITION",
           "its morph targets move it to a position that is too large for a float (element " + std::to_string(i) + ")");
    }
    const glm::vec3 normal = unit_or_zero(vertex.normal_ls), tangent = unit_or_zero(glm::vec3(vertex.tangent_ls));
    broken = broken || normal == glm::vec3(0);
    vertex.normal_ls = normal;
    vertex.tangent_ls = glm::vec4(tangent == glm::vec3(0) ? some_tangent(normal) : tangent, vertex.tangent_ls.w);
  }
  return broken;
}

std::string unread_morph(const VertexSource& source) {
  for (size_t t = 0; t < source.morph_weights.size(); ++t) {
    if (source.morph_weights[t] == 0) continue;
    for (const auto& [name, accessor] : source.primitive.targets[t]) {
      if (name != "POSITION" && name != "NORMAL" && name != "TANGENT") return name;
    }
  }
  return {};
}

}  // namespace chandelier::baker
