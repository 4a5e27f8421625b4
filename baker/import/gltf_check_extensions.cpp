// SPDX-License-Identifier: Apache-2.0
// Checks the JSON of the extensions that the importer reads.
#include "gltf_check.h"

namespace chandelier::baker {
namespace {

constexpr uint64_t most_count = 0xFFFFFFFEu;

/// The filter suits the mode and the stride (EXT_meshopt_compression, "Filters").
void check_filter(const Object& data, bool attributes, uint64_t stride) {
  data.text("filter");
  const std::string filter = data.json.value("filter", "NONE");
  if (filter == "NONE") return;
  const bool fits = filter == "OCTAHEDRAL"    ? stride == 4 || stride == 8
                    : filter == "QUATERNION"  ? stride == 8
                    : filter == "EXPONENTIAL" ? stride % 4 == 0
                                              : false;
  if (!attributes || !fits) data.bad("filter", "does not suit its mode and byteStride, or is unknown", filter);
}

}  // namespace

const char* meshopt_extension(const Json& view) {
  const auto all = view.find("extensions");
  if (all == view.end() || !all->is_object()) return nullptr;
  for (const char* name : {"EXT_meshopt_compression", "KHR_meshopt_compression"}) {
    if (all->contains(name)) return name;
  }
  return nullptr;
}

void check_meshopt_view(const Json& root, const Object& view) {
  const char* name = meshopt_extension(view.json);
  if (!name) return;
  const Object data = *view.extension(name);
  data.index("buffer", section_size(root, "buffers"), Need::required);
  data.integer("byteOffset", 0, largest_byte_count);
  data.integer("byteLength", 1, largest_byte_count, Need::required);
  data.integer("byteStride", 1, 256, Need::required);
  data.integer("count", 1, most_count, Need::required);
  data.text("mode", Need::required);
  const auto& mode = data.json["mode"].get_ref<const std::string&>();
  const auto stride = data.json["byteStride"].get<uint64_t>(), count = data.json["count"].get<uint64_t>();
  const auto bytes = data.json["byteLength"].get<uint64_t>();
  const bool attributes = mode == "ATTRIBUTES", triangles = mode == "TRIANGLES";
  if (!attributes && !triangles && mode != "INDICES") data.bad("mode", "is unknown", mode);
  if (attributes ? stride % 4 != 0 : stride != 2 && stride != 4)
    data.bad("byteStride", "does not suit its mode", stride);
  if (triangles && count % 3 != 0) data.bad("count", "is not a multiple of 3", count);
  check_filter(data, attributes, stride);
  if (view.json["byteLength"].get<uint64_t>() != stride * count) {
    data.bad("count", "times byteStride is not the buffer view's byteLength", count);
  }
  if (attributes && view.json.value("byteStride", stride) != stride) {
    data.bad("byteStride", "is not the buffer view's", stride);
  }
  // The least that the encodings need: two bits for 16 bytes of a vertex, a byte for a triangle or for an index.
  const uint64_t least = attributes ? stride * (count / 16 / 4) : triangles ? count / 3 : count;
  if (bytes < least) data.bad("byteLength", "is too short for its count", bytes);
}

void check_draco(const Json& root, const Object& primitive) {
  const auto data = primitive.extension("KHR_draco_mesh_compression");
  if (!data) return;
  data->index("bufferView", section_size(root, "bufferViews"), Need::required);
  const auto attributes = data->object("attributes", Need::required);
  for (const auto& [name, value] : attributes->json.items()) {
    attributes->integer(name.c_str(), 0, 0xFFFFFFFFu);
    if (!primitive.json["attributes"].contains(name))
      attributes->bad(name.c_str(), "is no attribute of its primitive", value);
  }
  const uint64_t mode = primitive.json.value("mode", uint64_t{4});
  if (mode != 4 && mode != 5) data->bad("bufferView", "compresses another mode than triangles", mode);
  if (!primitive.json.contains("indices")) fail(data->where, "its primitive has no indices");
}

void check_texture_transform(const Object& use) {
  const auto transform = use.extension("KHR_texture_transform");
  if (!transform) return;
  transform->numbers("offset", 2, -1e9, 1e9);
  transform->numbers("scale", 2, -1e9, 1e9);
  transform->number("rotation", -1e9, 1e9);
  transform->integer("texCoord", 0, largest_int);
}

void check_texture_sources(const Json& root, const Object& texture) {
  for (const char* name : {"KHR_texture_basisu", "EXT_texture_webp"}) {
    if (const auto extension = texture.extension(name)) extension->index("source", section_size(root, "images"));
  }
}

void check_instancing(const Json& root, const Object& node) {
  const auto instancing = node.extension("EXT_mesh_gpu_instancing");
  if (!instancing) return;
  const auto attributes = instancing->object("attributes", Need::required);
  for (const auto& [name, value] : attributes->json.items()) {
    attributes->index(name.c_str(), section_size(root, "accessors"));
  }
}

}  // namespace chandelier::baker
