// SPDX-License-Identifier: Apache-2.0
// Primitives: sizes, modes, indices, joints.
#include "geometry.h"

#include <numeric>

#include "morph.h"
#include "skin_vertices.h"
#include "vertices.h"

namespace chandelier::baker {
namespace {

constexpr uint64_t most_geometry_bytes = 1ull << 34;
constexpr uint64_t most_zeros = 1ull << 22;

const Json& json_of(const Gltf& gltf, size_t mesh, size_t primitive) {
  return gltf.json["meshes"][mesh]["primitives"][primitive];
}

/// Whether the primitive needs a buffer whose data the file does not name. An application would supply it.
bool lacks_data(const Gltf& gltf, const tinygltf::Primitive& primitive) {
  const auto lacks = [&](int accessor) {
    const int view = accessor < 0 ? -1 : gltf.model.accessors[static_cast<size_t>(accessor)].bufferView;
    return view >= 0 && !is_present(gltf, view);
  };
  for (const auto& [name, accessor] : primitive.attributes) {
    if (lacks(accessor)) return true;
  }
  return lacks(primitive.indices);
}

/// Why a primitive shows no triangles; empty if it may show some.
std::string reason_to_skip(const Gltf& gltf, const tinygltf::Primitive& primitive, bool compressed) {
  if (primitive.mode < TINYGLTF_MODE_TRIANGLES) return "points and lines are skipped";
  if (!primitive.attributes.contains("POSITION")) return "has no POSITION and is skipped";
  if (!compressed && lacks_data(gltf, primitive)) return "its buffer has no data, it is skipped";
  return {};
}

std::vector<uint32_t> corners_of(const VertexSource& source, DracoPrimitive* draco) {
  if (draco) return std::move(draco->indices);
  if (source.primitive.indices >= 0) {
    return read_indices(source.gltf, source.primitive.indices, source.vertex_count, source.where + ", indices");
  }
  std::vector<uint32_t> corners(fit_u32(source.vertex_count, "vertices"));
  std::iota(corners.begin(), corners.end(), 0u);
  return corners;
}

void read_skin(const VertexSource& source, Primitive& out, std::vector<std::string>& warnings) {
  const Elements joints = attribute_of(source, "JOINTS_0", 4, 4), weights = attribute_of(source, "WEIGHTS_0", 4, 4);
  if (joints.count == 0 || weights.count == 0) return;
  out.skin_vertices = read_skin_vertices(joints, weights, source.where, warnings);
  if (source.primitive.attributes.contains("JOINTS_1")) {
    warnings.push_back("only the first four joints of a vertex are kept, without JOINTS_1");
  }
}

void read_triangles(const Gltf& gltf, size_t mesh, size_t number, bool skinned, std::span<const double> morph_weights,
                    const std::string& where, ReadPrimitive& read) {
  const tinygltf::Primitive& in = gltf.model.meshes[mesh].primitives[number];
  const Json& json = json_of(gltf, mesh, number);
  std::optional<DracoPrimitive> draco;
  if (draco_of(json)) draco = decode_draco(gltf, json, where + ", KHR_draco_mesh_compression");
  const size_t vertices = gltf.model.accessors[static_cast<size_t>(in.attributes.at("POSITION"))].count;
  const VertexSource source{gltf, in, draco ? &*draco : nullptr, where, vertices, morph_weights};
  Primitive out;
  std::vector<uint32_t> corners = corners_of(source, draco ? &*draco : nullptr);
  const int mode = draco ? TINYGLTF_MODE_TRIANGLES : in.mode;
  if (mode == TINYGLTF_MODE_TRIANGLES && corners.size() % 3 != 0) {
    read.warnings.push_back("has vertices left over after the last whole triangle");
  }
  out.indices = triangle_list(mode, std::move(corners));
  if (out.indices.empty()) return;
  read_vertices(source, out);
  const std::string unread = unread_morph(source);
  if (!unread.empty()) read.warnings.push_back("morph targets of " + shortened(unread, 40) + " are ignored");
  if (skinned) read_skin(source, out, read.warnings);
  read.primitive = std::move(out);
}

}  // namespace

std::string place_of_primitive(const Gltf& gltf, size_t mesh, size_t primitive) {
  return place(gltf.json, "meshes", mesh) + ", primitive " + std::to_string(primitive);
}

std::vector<uint32_t> triangle_list(int mode, std::vector<uint32_t> corners) {
  const size_t n = corners.size();
  if (mode == TINYGLTF_MODE_TRIANGLES) {
    corners.resize(n / 3 * 3);
    return corners;
  }
  std::vector<uint32_t> out;
  out.reserve(n < 3 ? 0 : 3 * (n - 2));
  for (size_t i = 0; i + 2 < n; ++i) {  // glTF 2.0, 3.7.2.1: the formulas of the modes
    if (mode == TINYGLTF_MODE_TRIANGLE_STRIP) {
      out.insert(out.end(), {corners[i], corners[i + 1 + i % 2], corners[i + 2 - i % 2]});
    } else {
      out.insert(out.end(), {corners[i + 1], corners[i + 2], corners[0]});
    }
  }
  return out;
}

void add_size(const Gltf& gltf, size_t mesh, size_t number, std::span<const double> morph_weights,
              GeometrySize& total) {
  const tinygltf::Primitive& in = gltf.model.meshes[mesh].primitives[number];
  const std::string where = gltf.file + ": " + place_of_primitive(gltf, mesh, number);
  const Json* draco = draco_of(json_of(gltf, mesh, number));
  if (!reason_to_skip(gltf, in, draco).empty()) return;
  const auto count = [&](int accessor, const std::string& what, bool compressed) {
    const tinygltf::Accessor& checked = checked_accessor(gltf, accessor, where + ", " + what);
    if (checked.bufferView < 0 && !compressed) total.zeros += checked.count;
    return uint64_t{checked.count};
  };
  for (const auto& [name, accessor] : in.attributes) {
    count(accessor, "attribute " + name, draco && (*draco)["attributes"].contains(name));
  }
  const uint64_t vertices = gltf.model.accessors[static_cast<size_t>(in.attributes.at("POSITION"))].count;
  const uint64_t drawn = in.indices >= 0 ? count(in.indices, "indices", draco) : vertices;
  const uint64_t corners = in.mode == TINYGLTF_MODE_TRIANGLES ? drawn : 3 * drawn;
  const bool flat = !in.attributes.contains("NORMAL");  // each corner may become a vertex of its own
  total.bytes += (flat ? vertices + corners : vertices) * sizeof(Vertex) + corners * sizeof(uint32_t);
  add_morph_size(gltf, in, morph_weights, where, total.morphed);
  if (total.zeros > most_zeros) {
    fail(where, "accessors without a buffer view have more than " + std::to_string(most_zeros) +
                    " elements together (" + std::to_string(total.zeros) + ")");
  }
  if (total.bytes > most_geometry_bytes) {
    fail(where, "the geometry up to here needs more than " + std::to_string(most_geometry_bytes) + " bytes (" +
                    std::to_string(total.bytes) + ")");
  }
}

ReadPrimitive read_primitive(const Gltf& gltf, size_t mesh, size_t number, bool skinned,
                             std::span<const double> morph_weights) {
  const tinygltf::Primitive& in = gltf.model.meshes[mesh].primitives[number];
  ReadPrimitive out;
  const std::string skip = reason_to_skip(gltf, in, draco_of(json_of(gltf, mesh, number)));
  if (!skip.empty()) {
    out.warnings.push_back(skip);
    return out;
  }
  try {
    const std::string where = gltf.file + ": " + place_of_primitive(gltf, mesh, number);
    read_triangles(gltf, mesh, number, skinned, morph_weights, where, out);
  } catch (const Error& error) {
    out.error = error.what();
  }
  return out;
}

}  // namespace chandelier::baker
