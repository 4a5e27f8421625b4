// SPDX-License-Identifier: Apache-2.0
// libdraco allocates what a stream claims before it finds the stream too short. So the claims are read first, and must
// agree with the accessors, whose counts are bounded.
#include "draco.h"

#include <draco/compression/decode.h>
#include <draco/compression/point_cloud/point_cloud_decoder.h>
#include <draco/core/varint_decoding.h>
#include <draco/metadata/metadata_decoder.h>

#include <new>

namespace chandelier::baker {
namespace {

constexpr uint64_t most_per_byte = 2000;  // triangles or vertices that one byte can encode

struct Counts {
  uint64_t points = 0, triangles = 0;
};

draco::DecoderBuffer buffer_of(std::span<const uint8_t> bytes) {
  draco::DecoderBuffer buffer;
  buffer.Init(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  return buffer;
}

/// The counts in the stream's header (bitstream 2.2, as the extension asks). For an edgebreaker stream, points are the
/// vertices of its connectivity, which attributes may split.
Counts claimed_counts(std::span<const uint8_t> bytes, const std::string& where) {
  draco::DecoderBuffer buffer = buffer_of(bytes);
  draco::DracoHeader header;
  if (!draco::PointCloudDecoder::DecodeHeader(&buffer, &header).ok()) fail(where, "is not a Draco stream");
  if (header.version_major != 2 || header.version_minor != 2) {
    fail(where, "Draco bitstream is not 2.2 (" + std::to_string(header.version_major) + "." +
                    std::to_string(header.version_minor) + ")");
  }
  if (header.encoder_type != draco::TRIANGULAR_MESH) fail(where, "Draco stream is no triangle mesh");
  buffer.set_bitstream_version(DRACO_BITSTREAM_VERSION(header.version_major, header.version_minor));
  draco::GeometryMetadata metadata;
  if ((header.flags & METADATA_FLAG_MASK) && !draco::MetadataDecoder().DecodeGeometryMetadata(&buffer, &metadata)) {
    fail(where, "Draco metadata is damaged");
  }
  uint32_t points = 0, triangles = 0;
  uint8_t traversal = 0;
  const bool edgebreaker = header.encoder_method == draco::MESH_EDGEBREAKER_ENCODING;
  const bool read = edgebreaker ? buffer.Decode(&traversal) && draco::DecodeVarint(&points, &buffer) &&
                                      draco::DecodeVarint(&triangles, &buffer)
                                : draco::DecodeVarint(&triangles, &buffer) && draco::DecodeVarint(&points, &buffer);
  if (!read) fail(where, "Draco stream is cut short (" + std::to_string(bytes.size()) + " bytes)");
  return {points, triangles};
}

void need_equal(uint64_t decoded, uint64_t accessor, const char* what, const std::string& where) {
  if (decoded == accessor) return;
  fail(where, std::string("Draco stream has another number of ") + what + " than its accessors, which have " +
                  std::to_string(accessor) + " (" + std::to_string(decoded) + ")");
}

std::unique_ptr<draco::Mesh> decode_mesh(std::span<const uint8_t> bytes, const std::string& where) {
  try {
    draco::DecoderBuffer buffer = buffer_of(bytes);
    draco::Decoder decoder;
    auto result = decoder.DecodeMeshFromBuffer(&buffer);
    if (!result.ok()) {
      fail(where, "Draco stream cannot be decoded: " + shortened(result.status().error_msg_string(), 200));
    }
    return std::move(result).value();
  } catch (const std::bad_alloc&) {
    fail(where, "Draco stream asks for more memory than there is");
  } catch (const std::length_error&) {
    fail(where, "Draco stream asks for more memory than there is");
  }
}

int component_type_of(draco::DataType type, const std::string& where) {
  switch (type) {
    case draco::DT_INT8:
      return TINYGLTF_COMPONENT_TYPE_BYTE;
    case draco::DT_UINT8:
      return TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE;
    case draco::DT_INT16:
      return TINYGLTF_COMPONENT_TYPE_SHORT;
    case draco::DT_UINT16:
      return TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT;
    case draco::DT_UINT32:
      return TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT;
    case draco::DT_FLOAT32:
      return TINYGLTF_COMPONENT_TYPE_FLOAT;
    default:
      fail(where, "Draco attribute has a type that glTF lacks (" + std::to_string(type) + ")");
  }
}

Elements read_attribute(const draco::Mesh& mesh, uint32_t id, const tinygltf::Accessor& accessor,
                        const std::string& where) {
  const draco::PointAttribute* attribute = mesh.GetAttributeByUniqueId(id);
  if (!attribute) fail(where, "Draco stream has no such attribute (" + std::to_string(id) + ")");
  Elements out;
  out.components = static_cast<size_t>(attribute->num_components());
  out.component_type = component_type_of(attribute->data_type(), where);
  out.normalized = accessor.normalized;
  out.count = mesh.num_points();
  out.stride = out.components * component_size(out.component_type);
  const uint64_t stored = attribute->buffer() ? attribute->buffer()->data_size() : 0;
  if (static_cast<uint64_t>(attribute->byte_stride()) != out.stride || stored < attribute->size() * out.stride) {
    fail(where, "Draco attribute is damaged");
  }
  out.own.resize(out.count * out.stride);
  for (uint32_t i = 0; i < out.count; ++i) {
    const draco::AttributeValueIndex value = attribute->mapped_index(draco::PointIndex(i));
    if (value.value() >= attribute->size()) fail(where, "Draco attribute is damaged");
    attribute->GetValue(value, out.own.data() + i * out.stride);
  }
  out.data = out.own.data();
  return out;
}

}  // namespace

const Json* draco_of(const Json& primitive) {
  const auto all = primitive.find("extensions");
  if (all == primitive.end() || !all->is_object()) return nullptr;
  const auto draco = all->find("KHR_draco_mesh_compression");
  return draco == all->end() ? nullptr : &*draco;
}

DracoPrimitive decode_draco(const Gltf& gltf, const Json& primitive, const std::string& where) {
  const Json& extension = *draco_of(primitive);
  const auto bytes = view_bytes(gltf, extension["bufferView"].get<int>(), where);
  const auto& accessors = gltf.model.accessors;
  const Counts claimed = claimed_counts(bytes, where);
  if (claimed.points + claimed.triangles > most_per_byte * bytes.size()) {
    fail(where, "Draco stream claims more than it can hold (" + std::to_string(claimed.points) + " vertices in " +
                    std::to_string(bytes.size()) + " bytes)");
  }
  const bool strip = primitive.value("mode", TINYGLTF_MODE_TRIANGLES) != TINYGLTF_MODE_TRIANGLES;
  const uint64_t corners = accessors[primitive["indices"].get<size_t>()].count;
  if (!strip) need_equal(claimed.triangles * 3, corners, "triangle corners", where);
  const std::unique_ptr<draco::Mesh> mesh = decode_mesh(bytes, where);
  DracoPrimitive out;
  for (const auto& [name, id] : extension["attributes"].items()) {
    const tinygltf::Accessor& accessor = accessors[primitive["attributes"][name].get<size_t>()];
    need_equal(mesh->num_points(), accessor.count, "vertices", where);
    out.attributes[name] = read_attribute(*mesh, id.get<uint32_t>(), accessor, where + ", attribute " + name);
  }
  out.indices.reserve(size_t{mesh->num_faces()} * 3);
  for (draco::FaceIndex face(0); face < mesh->num_faces(); ++face) {
    for (const draco::PointIndex& corner : mesh->face(face)) {
      if (corner.value() >= mesh->num_points()) fail(where, "Draco stream has an index out of range");
      out.indices.push_back(corner.value());
    }
  }
  return out;
}

}  // namespace chandelier::baker
