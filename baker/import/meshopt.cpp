// SPDX-License-Identifier: Apache-2.0
// meshoptimizer's decoders are safe on hostile bytes; sizes, strides and filters were checked with the JSON.
#include "meshopt.h"

#include <meshoptimizer.h>
#include <tbb/parallel_for.h>

#include "gltf_check.h"

namespace chandelier::baker {
namespace {

constexpr uint64_t most_decoded_bytes = 1ull << 34;

void apply_filter(const std::string& filter, std::vector<uint8_t>& data, size_t count, size_t stride) {
  if (filter == "OCTAHEDRAL") meshopt_decodeFilterOct(data.data(), count, stride);
  if (filter == "QUATERNION") meshopt_decodeFilterQuat(data.data(), count, stride);
  if (filter == "EXPONENTIAL") meshopt_decodeFilterExp(data.data(), count, stride);
}

Buffer decode_view(const Gltf& gltf, size_t number, const char* extension) {
  const Json& json = gltf.json["bufferViews"][number]["extensions"][extension];
  const std::string where = gltf.file + ": " + place(gltf.json, "bufferViews", number) + ", " + extension;
  const auto count = json["count"].get<size_t>(), stride = json["byteStride"].get<size_t>();
  const auto bytes = buffer_bytes(gltf, json["buffer"].get<size_t>(), json.value("byteOffset", uint64_t{0}),
                                  json["byteLength"].get<uint64_t>(), where + ":");
  const std::string mode = json["mode"].get<std::string>();
  std::vector<uint8_t> out(count * stride);
  const int fault =
      mode == "ATTRIBUTES"  ? meshopt_decodeVertexBuffer(out.data(), count, stride, bytes.data(), bytes.size())
      : mode == "TRIANGLES" ? meshopt_decodeIndexBuffer(out.data(), count, stride, bytes.data(), bytes.size())
                            : meshopt_decodeIndexSequence(out.data(), count, stride, bytes.data(), bytes.size());
  if (fault != 0) {
    const std::string why = fault == -1 ? "of another format or version" : fault == -2 ? "cut short" : "damaged";
    fail(where, "cannot be decoded as " + mode + ": " + why + " (" + std::to_string(bytes.size()) + " bytes)");
  }
  apply_filter(json.value("filter", "NONE"), out, count, stride);
  return {bytes_of(std::move(out)), true, ""};
}

}  // namespace

void decode_meshopt_views(Gltf& gltf) {
  gltf.decoded_views.resize(gltf.model.bufferViews.size());
  std::vector<const char*> extensions(gltf.decoded_views.size(), nullptr);
  uint64_t total = 0;
  for (size_t i = 0; i < extensions.size(); ++i) {
    const Json& view = gltf.json["bufferViews"][i];
    extensions[i] = meshopt_extension(view);
    if (extensions[i]) total += view["byteLength"].get<uint64_t>();
    if (total > most_decoded_bytes) {
      fail(gltf.file + ": " + place(gltf.json, "bufferViews", i), "the compressed views up to here have more than " +
                                                                      std::to_string(most_decoded_bytes) + " bytes (" +
                                                                      std::to_string(total) + ")");
    }
  }
  tbb::parallel_for(size_t{0}, extensions.size(), [&](size_t i) {
    if (!extensions[i]) return;
    try {
      gltf.decoded_views[i] = decode_view(gltf, i, extensions[i]);
    } catch (const Error& error) {
      gltf.decoded_views[i].error = error.what();
    }
  });
}

}  // namespace chandelier::baker
