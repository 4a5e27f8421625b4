// SPDX-License-Identifier: Apache-2.0
// Each block of vertices is filled attribute after attribute while caches hold it. Normals and tangents become unit
// length.
#include "vertices.h"

#include <algorithm>
#include <cmath>

#include "morph.h"

namespace chandelier::baker {
namespace {

constexpr size_t most_components = 4;

struct Attribute {
  std::string where;
  Elements elements;
  FirstFault not_finite = {};
};

/// Calls `put(vertex, values)` for each vertex of a block.
template <typename Put>
void fill(Attribute& attribute, size_t first, size_t count, std::vector<Vertex>& vertices, Put put) {
  if (attribute.elements.count == 0) return;
  float values[1024 * most_components];
  const size_t bad = to_floats(attribute.elements, first, count, values);
  if (bad != SIZE_MAX) return attribute.not_finite.note(bad);
  const float* each = values;
  for (size_t i = first; i < first + count; ++i, each += attribute.elements.components) put(vertices[i], each);
}

uint32_t pack_color(const float* rgb, size_t components) {
  uint32_t out = 0;
  for (size_t c = 0; c < 4; ++c) {
    const float value = c < components ? std::clamp(rgb[c], 0.0f, 1.0f) : 1.0f;
    out |= static_cast<uint32_t>(std::lround(value * 255.0f)) << (8 * c);
  }
  return out;
}

glm::vec3 area_normal(const Primitive& primitive, size_t triangle) {
  const auto corner = [&](size_t c) {
    return glm::dvec3(primitive.vertices[primitive.indices[3 * triangle + c]].position_ls);
  };
  const glm::dvec3 cross = glm::cross(corner(1) - corner(0), corner(2) - corner(0));
  const double length = glm::length(cross);
  return length > 0 && std::isfinite(length) ? glm::vec3(cross / length) : glm::vec3(0);
}

/// Normals without a direction become that of a triangle at the vertex.
void mend_normals(Primitive& primitive) {
  std::vector<uint8_t> broken(primitive.vertices.size(), 0);
  for (size_t i = 0; i < broken.size(); ++i) {
    broken[i] = primitive.vertices[i].normal_ls == glm::vec3(0);
    if (broken[i]) primitive.vertices[i].normal_ls = {0, 1, 0};
  }
  for (size_t t = 0; t < primitive.indices.size() / 3; ++t) {
    const glm::vec3 normal = area_normal(primitive, t);
    if (normal == glm::vec3(0)) continue;
    for (size_t c = 0; c < 3; ++c) {
      const uint32_t v = primitive.indices[3 * t + c];
      if (broken[v]) primitive.vertices[v].normal_ls = normal;
    }
  }
  for (size_t i = 0; i < broken.size(); ++i) {
    Vertex& vertex = primitive.vertices[i];
    if (broken[i]) vertex.tangent_ls = glm::vec4(some_tangent(vertex.normal_ls), vertex.tangent_ls.w);
  }
}

struct Attributes {
  Attribute position, normal, tangent, uv0, uv1, color;
};

Attributes open_attributes(const VertexSource& source) {
  const auto open = [&](const char* name, size_t least, size_t most) {
    return Attribute{source.where + ", attribute " + name, attribute_of(source, name, least, most)};
  };
  return {open("POSITION", 3, 3),   open("NORMAL", 3, 3),     open("TANGENT", 4, 4),
          open("TEXCOORD_0", 2, 2), open("TEXCOORD_1", 2, 2), open("COLOR_0", 3, 4)};
}

/// Returns whether a normal has no direction.
bool fill_block(Attributes& in, size_t first, size_t count, std::vector<Vertex>& vertices) {
  bool broken = false;
  const size_t color_components = in.color.elements.components;
  const bool has_tangents = in.tangent.elements.count > 0;
  fill(in.position, first, count, vertices, [](Vertex& v, const float* p) { v.position_ls = {p[0], p[1], p[2]}; });
  fill(in.normal, first, count, vertices, [&](Vertex& v, const float* n) {
    v.normal_ls = unit_or_zero({n[0], n[1], n[2]});
    broken = broken || v.normal_ls == glm::vec3(0);
  });
  fill(in.tangent, first, count, vertices, [](Vertex& v, const float* t) {
    const glm::vec3 unit = unit_or_zero({t[0], t[1], t[2]});
    v.tangent_ls = glm::vec4(unit == glm::vec3(0) ? some_tangent(v.normal_ls) : unit, t[3] < 0 ? -1.0f : 1.0f);
  });
  for (size_t i = first; !has_tangents && i < first + count; ++i) {
    vertices[i].tangent_ls = glm::vec4(some_tangent(vertices[i].normal_ls), 1);
  }
  fill(in.uv0, first, count, vertices, [](Vertex& v, const float* uv) { v.uv0 = {uv[0], uv[1]}; });
  fill(in.uv1, first, count, vertices, [](Vertex& v, const float* uv) { v.uv1 = {uv[0], uv[1]}; });
  fill(in.color, first, count, vertices, [&](Vertex& v, const float* c) { v.color = pack_color(c, color_components); });
  return broken;
}

}  // namespace

glm::vec3 unit_or_zero(const glm::vec3& v) {
  const glm::dvec3 wide = v;
  const double length = glm::length(wide);
  return length > 1e-12 ? glm::vec3(wide / length) : glm::vec3(0);
}

glm::vec3 some_tangent(const glm::vec3& n) {
  const glm::vec3 axis = std::abs(n.x) < 0.9f ? glm::vec3(1, 0, 0) : glm::vec3(0, 1, 0);
  return glm::normalize(axis - n * glm::dot(n, axis));
}

Elements attribute_of(const VertexSource& source, const char* name, size_t least, size_t most) {
  const auto it = source.primitive.attributes.find(name);
  if (it == source.primitive.attributes.end()) return {};
  const std::string where = source.where + ", attribute " + name;
  Elements out;
  if (source.draco && source.draco->attributes.contains(name)) {
    const Elements& decoded = source.draco->attributes.at(name);  // it keeps the data
    out = {decoded.data,
           decoded.stride,
           decoded.count,
           decoded.components,
           decoded.component_type,
           decoded.normalized,
           {}};
    if (out.components < least || out.components > most) {
      fail(where, "Draco attribute has the wrong type (" + std::to_string(out.components) + " components)");
    }
  } else {
    out = elements_of(source.gltf, it->second, least, most, where);
  }
  if (out.count != source.vertex_count) {
    fail(where, "has a different number of elements than POSITION, which has " + std::to_string(source.vertex_count) +
                    " (" + std::to_string(out.count) + ")");
  }
  return out;
}

void read_vertices(const VertexSource& source, Primitive& out) {
  Attributes in = open_attributes(source);
  out.needs_normals = in.normal.elements.count == 0;
  if (out.needs_normals) in.tangent.elements.count = 0;  // without normals, tangents do not count
  out.needs_tangents = in.tangent.elements.count == 0;
  out.vertices.resize(source.vertex_count);
  std::atomic<bool> broken{false};
  for_blocks(out.vertices.size(), [&](size_t first, size_t count) {
    if (fill_block(in, first, count, out.vertices)) broken = true;
  });
  for (const Attribute* each : {&in.position, &in.normal, &in.tangent, &in.uv0, &in.uv1, &in.color}) {
    if (each->not_finite.at() != SIZE_MAX) fail_not_finite(each->elements, each->not_finite.at(), each->where);
  }
  if (!source.morph_weights.empty() && apply_morphs(source, out)) broken = true;
  if (broken) mend_normals(out);
}

}  // namespace chandelier::baker
