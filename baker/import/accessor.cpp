// SPDX-License-Identifier: Apache-2.0
// Accessors: every range is checked before a byte is read.
#include "accessor.h"

#include <algorithm>
#include <cmath>
#include <cstring>

namespace chandelier::baker {
namespace {

std::size_t component_size(int type) {
  switch (type) {
    case TINYGLTF_COMPONENT_TYPE_BYTE:
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
      return 1;
    case TINYGLTF_COMPONENT_TYPE_SHORT:
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
      return 2;
    default:
      return 4;
  }
}

template <typename T>
T value_at(const std::uint8_t* bytes) {
  T value;
  std::memcpy(&value, bytes, sizeof(T));
  return value;
}

/// glTF 2.0, 3.11: normalized integers.
float component_at(const std::uint8_t* bytes, int type, bool normalized) {
  switch (type) {
    case TINYGLTF_COMPONENT_TYPE_BYTE: {
      const auto v = static_cast<float>(value_at<std::int8_t>(bytes));
      return normalized ? std::max(v / 127.0f, -1.0f) : v;
    }
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
      return static_cast<float>(*bytes) / (normalized ? 255.0f : 1.0f);
    case TINYGLTF_COMPONENT_TYPE_SHORT: {
      const auto v = static_cast<float>(value_at<std::int16_t>(bytes));
      return normalized ? std::max(v / 32767.0f, -1.0f) : v;
    }
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
      return static_cast<float>(value_at<std::uint16_t>(bytes)) / (normalized ? 65535.0f : 1.0f);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT: {
      const double v = value_at<std::uint32_t>(bytes);
      return static_cast<float>(normalized ? v / 4294967295.0 : v);
    }
    default:
      return value_at<float>(bytes);
  }
}

std::uint32_t index_at(const std::uint8_t* bytes, int type) {
  switch (component_size(type)) {
    case 1:
      return *bytes;
    case 2:
      return value_at<std::uint16_t>(bytes);
    default:
      return value_at<std::uint32_t>(bytes);
  }
}

void need_unsigned(int type, const std::string& where) {
  if (type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE || type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT ||
      type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT) {
    return;
  }
  fail(where, "component type cannot hold indices (" + std::to_string(type) + ")");
}

/// The bytes of `count` elements `stride` bytes apart in a buffer view.
std::span<const std::uint8_t> element_bytes(const Gltf& gltf, int view, std::uint64_t offset, std::uint64_t count,
                                            std::uint64_t stride, std::uint64_t element, const std::string& where) {
  const auto bytes = view_bytes(gltf, view, where);
  if (count == 0) return {};
  if (stride < element) {
    fail(where, "byteStride of buffer view " + std::to_string(view) + " is less than an element of " +
                    std::to_string(element) + " bytes (" + std::to_string(stride) + ")");
  }
  // (count - 1) * stride + element <= bytes - offset, without overflow
  const bool fits = offset <= bytes.size() && element <= bytes.size() - offset &&
                    count - 1 <= (bytes.size() - offset - element) / stride;
  if (!fits) {
    fail(where, "accessor ends past buffer view " + std::to_string(view) + " (" + std::to_string(count) +
                    " elements of " + std::to_string(element) + " bytes, stride " + std::to_string(stride) +
                    ", at byte " + std::to_string(offset) + " of " + std::to_string(bytes.size()) + ")");
  }
  return bytes.subspan(offset);
}

/// Calls `store(element number, bytes)` for the base data, then for the sparse replacements.
template <typename Store>
void for_each_element(const Gltf& gltf, const tinygltf::Accessor& accessor, std::size_t element,
                      const std::string& where, Store store) {
  if (accessor.bufferView >= 0) {
    const auto& view = gltf.model.bufferViews[static_cast<std::size_t>(accessor.bufferView)];
    const std::size_t stride = view.byteStride ? view.byteStride : element;
    const auto bytes =
        element_bytes(gltf, accessor.bufferView, accessor.byteOffset, accessor.count, stride, element, where);
    for (std::size_t i = 0; i < accessor.count; ++i) store(i, bytes.data() + i * stride);
  }
  if (!accessor.sparse.isSparse) return;
  const auto& sparse = accessor.sparse;
  const auto count = static_cast<std::size_t>(sparse.count);
  const std::size_t index_size = component_size(sparse.indices.componentType);
  need_unsigned(sparse.indices.componentType, where + ", sparse indices");
  const auto indices =
      element_bytes(gltf, sparse.indices.bufferView, static_cast<std::uint64_t>(sparse.indices.byteOffset), count,
                    index_size, index_size, where + ", sparse indices");
  const auto values =
      element_bytes(gltf, sparse.values.bufferView, static_cast<std::uint64_t>(sparse.values.byteOffset), count,
                    element, element, where + ", sparse values");
  for (std::size_t i = 0; i < count; ++i) {
    const std::uint32_t at = index_at(indices.data() + i * index_size, sparse.indices.componentType);
    if (at >= accessor.count) fail(where + ", sparse indices", "index is out of range (" + std::to_string(at) + ")");
    store(at, values.data() + i * element);
  }
}

}  // namespace

const tinygltf::Accessor& checked_accessor(const Gltf& gltf, int index, const std::string& where) {
  const tinygltf::Accessor& accessor = gltf.model.accessors[static_cast<std::size_t>(index)];
  if (accessor.sparse.isSparse && static_cast<std::uint64_t>(accessor.sparse.count) > accessor.count) {
    fail(where, "more sparse elements than elements (" + std::to_string(accessor.sparse.count) + ")");
  }
  if (accessor.bufferView >= 0) {  // before anything is allocated for it
    const auto bytes = view_bytes(gltf, accessor.bufferView, where);
    if (accessor.count > bytes.size()) {
      fail(where, "accessor ends past buffer view " + std::to_string(accessor.bufferView) + " (" +
                      std::to_string(accessor.count) + " elements in " + std::to_string(bytes.size()) + " bytes)");
    }
  }
  return accessor;
}

Floats read_floats(const Gltf& gltf, int index, std::size_t least_components, std::size_t most_components,
                   const std::string& where) {
  const tinygltf::Accessor& accessor = checked_accessor(gltf, index, where);
  const int type = accessor.type;
  const bool plain = type == TINYGLTF_TYPE_SCALAR || (type >= TINYGLTF_TYPE_VEC2 && type <= TINYGLTF_TYPE_VEC4);
  Floats out;
  out.components = static_cast<std::size_t>(tinygltf::GetNumComponentsInType(static_cast<std::uint32_t>(type)));
  if (!plain || out.components < least_components || out.components > most_components) {
    fail(where, "accessor " + std::to_string(index) + " has the wrong type (" + std::to_string(out.components) +
                    " components)");
  }
  out.count = accessor.count;
  out.values.resize(out.count * out.components);
  const std::size_t size = component_size(accessor.componentType);
  for_each_element(gltf, accessor, size * out.components, where, [&](std::size_t i, const std::uint8_t* bytes) {
    for (std::size_t c = 0; c < out.components; ++c) {
      out.values[i * out.components + c] = component_at(bytes + c * size, accessor.componentType, accessor.normalized);
    }
  });
  for (std::size_t i = 0; i < out.values.size(); ++i) {
    if (!std::isfinite(out.values[i])) {
      fail(where, "value is not finite (" + std::to_string(out.values[i]) + " in element " +
                      std::to_string(i / out.components) + ")");
    }
  }
  return out;
}

std::vector<std::uint32_t> read_indices(const Gltf& gltf, int index, std::uint64_t end, const std::string& where) {
  const tinygltf::Accessor& accessor = checked_accessor(gltf, index, where);
  if (accessor.type != TINYGLTF_TYPE_SCALAR) fail(where, "accessor " + std::to_string(index) + " is not SCALAR");
  need_unsigned(accessor.componentType, where);
  std::vector<std::uint32_t> out(accessor.count, 0);
  for_each_element(gltf, accessor, component_size(accessor.componentType), where,
                   [&](std::size_t i, const std::uint8_t* bytes) { out[i] = index_at(bytes, accessor.componentType); });
  for (std::size_t i = 0; i < out.size(); ++i) {
    if (out[i] >= end) {
      fail(where, "index is out of range, there are " + std::to_string(end) + " vertices (" + std::to_string(out[i]) +
                      " at " + std::to_string(i) + ")");
    }
  }
  return out;
}

}  // namespace chandelier::baker
