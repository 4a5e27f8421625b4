// SPDX-License-Identifier: Apache-2.0
// Primitives: modes, attributes, missing normals.
#include "geometry.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "accessor.h"

namespace chandelier::baker {
namespace {

constexpr std::uint64_t kMostBytes = 1ull << 34;
constexpr std::uint64_t kMostZeros = 1ull << 22;

std::string place_of(const Gltf& gltf, std::size_t mesh, std::size_t primitive) {
  return place(gltf.json, "meshes", mesh) + ", primitive " + std::to_string(primitive);
}

struct Source {
  const Gltf& gltf;
  const tinygltf::Primitive& primitive;
  const std::string& where;
  std::size_t vertex_count;
};

/// An attribute's values, one per vertex; empty where the primitive has none.
Floats read_attribute(const Source& source, const char* name, std::size_t least, std::size_t most) {
  const auto it = source.primitive.attributes.find(name);
  if (it == source.primitive.attributes.end()) return {};
  const std::string where = source.where + ", attribute " + name;
  Floats values = read_floats(source.gltf, it->second, least, most, where);
  if (values.count != source.vertex_count) {
    fail(where, "has another count than POSITION, which has " + std::to_string(source.vertex_count) + " (" +
                    std::to_string(values.count) + ")");
  }
  return values;
}

std::uint32_t pack_color(const float* rgb, std::size_t components) {
  std::uint32_t out = 0;
  for (std::size_t c = 0; c < 4; ++c) {
    const float value = c < components ? std::clamp(rgb[c], 0.0f, 1.0f) : 1.0f;
    out |= static_cast<std::uint32_t>(std::lround(value * 255.0f)) << (8 * c);
  }
  return out;
}

glm::vec3 vec3_at(const Floats& floats, std::size_t i) {
  const float* v = floats.values.data() + i * floats.components;
  return {v[0], v[1], v[2]};
}

void read_uvs(const Source& source, std::vector<Vertex>& vertices) {
  const Floats uv0 = read_attribute(source, "TEXCOORD_0", 2, 2);
  for (std::size_t i = 0; i < uv0.count; ++i) vertices[i].uv0 = {uv0.values[2 * i], uv0.values[2 * i + 1]};
  const Floats uv1 = read_attribute(source, "TEXCOORD_1", 2, 2);
  for (std::size_t i = 0; i < uv1.count; ++i) vertices[i].uv1 = {uv1.values[2 * i], uv1.values[2 * i + 1]};
}

void read_colors(const Source& source, std::vector<Vertex>& vertices) {
  const Floats colors = read_attribute(source, "COLOR_0", 3, 4);
  for (std::size_t i = 0; i < colors.count; ++i) {
    vertices[i].color = pack_color(colors.values.data() + i * colors.components, colors.components);
  }
}

/// Returns whether the primitive has normals.
bool read_normals(const Source& source, std::vector<Vertex>& vertices) {
  const Floats normals = read_attribute(source, "NORMAL", 3, 3);
  for (std::size_t i = 0; i < normals.count; ++i) vertices[i].normal_ls = vec3_at(normals, i);
  return !normals.values.empty();
}

/// Returns whether the primitive has tangents.
bool read_tangents(const Source& source, std::vector<Vertex>& vertices) {
  const Floats tangents = read_attribute(source, "TANGENT", 4, 4);
  for (std::size_t i = 0; i < tangents.count; ++i) {
    vertices[i].tangent_ls = glm::vec4(vec3_at(tangents, i), tangents.values[4 * i + 3] < 0 ? -1.0f : 1.0f);
  }
  return !tangents.values.empty();
}

glm::vec3 area_normal(const Primitive& primitive, std::size_t triangle) {
  const auto corner = [&](std::size_t c) {
    return glm::dvec3(primitive.vertices[primitive.indices[3 * triangle + c]].position_ls);
  };
  const glm::dvec3 cross = glm::cross(corner(1) - corner(0), corner(2) - corner(0));
  const double length = glm::length(cross);
  return length > 0 && std::isfinite(length) ? glm::vec3(cross / length) : glm::vec3(0);
}

/// Unit normals; where a file's own has no direction, that of a triangle at the vertex.
void mend_normals(Primitive& primitive) {
  std::vector<std::uint8_t> broken(primitive.vertices.size(), 0);
  bool any = false;
  for (std::size_t i = 0; i < primitive.vertices.size(); ++i) {
    const glm::dvec3 normal = primitive.vertices[i].normal_ls;
    const double length = glm::length(normal);
    broken[i] = !(length > 1e-12);
    any = any || broken[i];
    if (!broken[i]) primitive.vertices[i].normal_ls = glm::vec3(normal / length);
  }
  if (!any) return;
  for (std::size_t i = 0; i < broken.size(); ++i) {
    if (broken[i]) primitive.vertices[i].normal_ls = {0, 1, 0};
  }
  for (std::size_t t = 0; t < primitive.indices.size() / 3; ++t) {
    const glm::vec3 normal = area_normal(primitive, t);
    if (normal == glm::vec3(0)) continue;
    for (std::size_t c = 0; c < 3; ++c) {
      const std::uint32_t v = primitive.indices[3 * t + c];
      if (broken[v]) primitive.vertices[v].normal_ls = normal;
    }
  }
}

/// Any unit tangent across the normal.
glm::vec3 some_tangent(const glm::vec3& n) {
  const glm::vec3 axis = std::abs(n.x) < 0.9f ? glm::vec3(1, 0, 0) : glm::vec3(0, 1, 0);
  return glm::normalize(axis - n * glm::dot(n, axis));
}

void mend_tangents(std::vector<Vertex>& vertices) {
  for (Vertex& vertex : vertices) {
    const glm::dvec3 tangent(vertex.tangent_ls);
    const double length = glm::length(tangent);
    const glm::vec3 unit = length > 1e-12 ? glm::vec3(tangent / length) : some_tangent(vertex.normal_ls);
    vertex.tangent_ls = glm::vec4(unit, vertex.tangent_ls.w);
  }
}

void clear_tangents(std::vector<Vertex>& vertices) {
  for (Vertex& vertex : vertices) vertex.tangent_ls = {0, 0, 0, 1};
}

}  // namespace

std::vector<std::uint32_t> triangle_list(int mode, const std::vector<std::uint32_t>& corners) {
  std::vector<std::uint32_t> out;
  const std::size_t n = corners.size();
  if (mode == TINYGLTF_MODE_TRIANGLES) {
    out.assign(corners.begin(), corners.begin() + static_cast<std::ptrdiff_t>(n / 3 * 3));
    return out;
  }
  for (std::size_t i = 0; i + 2 < n; ++i) {  // glTF 2.0, 3.7.2.1: the formulas of the modes
    if (mode == TINYGLTF_MODE_TRIANGLE_STRIP) {
      out.insert(out.end(), {corners[i], corners[i + 1 + i % 2], corners[i + 2 - i % 2]});
    } else {
      out.insert(out.end(), {corners[i + 1], corners[i + 2], corners[0]});
    }
  }
  return out;
}

void make_flat(Primitive& primitive) {
  std::vector<Vertex> vertices;
  vertices.reserve(primitive.indices.size());
  for (std::size_t t = 0; t < primitive.indices.size() / 3; ++t) {
    const glm::vec3 normal = area_normal(primitive, t);
    for (std::size_t c = 0; c < 3; ++c) {
      Vertex vertex = primitive.vertices[primitive.indices[3 * t + c]];
      vertex.normal_ls = normal == glm::vec3(0) ? glm::vec3(0, 1, 0) : normal;
      vertices.push_back(vertex);
    }
  }
  primitive.vertices = std::move(vertices);
  primitive.indices.resize(primitive.vertices.size());
  std::iota(primitive.indices.begin(), primitive.indices.end(), 0u);
}

void add_size(const Gltf& gltf, std::size_t mesh, std::size_t number, GeometrySize& total) {
  const tinygltf::Primitive& in = gltf.model.meshes[mesh].primitives[number];
  const std::string where = gltf.file + ": " + place_of(gltf, mesh, number);
  if (in.mode < TINYGLTF_MODE_TRIANGLES || !in.attributes.contains("POSITION")) return;
  const auto count = [&](int accessor, const std::string& what) {
    const tinygltf::Accessor& checked = checked_accessor(gltf, accessor, where + ", " + what);
    if (checked.bufferView < 0) total.zeros += checked.count;
    return std::uint64_t{checked.count};
  };
  for (const auto& [name, accessor] : in.attributes) count(accessor, "attribute " + name);
  const std::uint64_t vertices = gltf.model.accessors[static_cast<std::size_t>(in.attributes.at("POSITION"))].count;
  const std::uint64_t drawn = in.indices >= 0 ? count(in.indices, "indices") : vertices;
  const std::uint64_t corners = in.mode == TINYGLTF_MODE_TRIANGLES ? drawn : 3 * drawn;
  const bool flat = !in.attributes.contains("NORMAL");  // each corner a vertex of its own
  total.bytes += (flat ? vertices + corners : vertices) * sizeof(Vertex) + corners * sizeof(std::uint32_t);
  if (total.zeros > kMostZeros) {
    fail(where, "accessors without a buffer view have more than " + std::to_string(kMostZeros) +
                    " elements together (" + std::to_string(total.zeros) + ")");
  }
  if (total.bytes > kMostBytes) {
    fail(where, "the geometry up to here needs more than " + std::to_string(kMostBytes) + " bytes (" +
                    std::to_string(total.bytes) + ")");
  }
}

std::optional<Primitive> read_primitive(const Gltf& gltf, std::size_t mesh, std::size_t number, Warnings& warnings) {
  const tinygltf::Primitive& in = gltf.model.meshes[mesh].primitives[number];
  const std::string here = place_of(gltf, mesh, number);
  const std::string where = gltf.file + ": " + here;
  if (in.mode < TINYGLTF_MODE_TRIANGLES) {
    warnings.add(gltf.file, here, "points and lines are skipped");
    return std::nullopt;
  }
  if (!in.attributes.contains("POSITION")) {
    warnings.add(gltf.file, here, "has no POSITION and is skipped");
    return std::nullopt;
  }
  if (!in.targets.empty()) warnings.add(gltf.file, here, "morph targets are ignored: the base mesh is baked");

  const Floats positions = read_floats(gltf, in.attributes.at("POSITION"), 3, 3, where + ", attribute POSITION");
  Primitive out;
  out.vertices.resize(positions.count);
  for (std::size_t i = 0; i < positions.count; ++i) out.vertices[i].position_ls = vec3_at(positions, i);
  std::vector<std::uint32_t> corners;
  if (in.indices >= 0) {
    corners = read_indices(gltf, in.indices, positions.count, where + ", indices");
  } else {
    corners.resize(fit_u32(positions.count, "vertices"));
    std::iota(corners.begin(), corners.end(), 0u);
  }
  if (in.mode == TINYGLTF_MODE_TRIANGLES && corners.size() % 3 != 0) {
    warnings.add(gltf.file, here, "has vertices left over after the last whole triangle");
  }
  out.indices = triangle_list(in.mode, corners);
  if (out.indices.empty()) return std::nullopt;

  const Source source{gltf, in, where, positions.count};
  read_uvs(source, out.vertices);
  read_colors(source, out.vertices);
  const bool has_normals = read_normals(source, out.vertices);
  bool has_tangents = read_tangents(source, out.vertices) && has_normals;  // without normals, tangents do not count
  if (!has_tangents) clear_tangents(out.vertices);
  if (has_normals) {
    mend_normals(out);
  } else {
    make_flat(out);
  }
  mend_tangents(out.vertices);
  out.needs_tangents = !has_tangents;
  return out;
}

}  // namespace chandelier::baker
