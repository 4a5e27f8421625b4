// SPDX-License-Identifier: Apache-2.0
// Accessors: every range is checked before a byte is read, and then read in blocks of one type.
#include "accessor.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>

namespace chandelier::baker {
namespace {

template <typename T>
T value_at(const uint8_t* bytes) {
  T value;
  std::memcpy(&value, bytes, sizeof(T));
  return value;
}

/// glTF 2.0, 3.11: normalized integers.
template <typename T>
float to_float(T value, bool normalized) {
  if constexpr (std::is_same_v<T, float>) return value;
  if constexpr (std::is_same_v<T, uint32_t>) {
    return static_cast<float>(normalized ? static_cast<double>(value) / 4294967295.0 : static_cast<double>(value));
  } else {
    const auto v = static_cast<float>(value);
    if (!normalized) return v;
    return std::max(v / static_cast<float>(std::numeric_limits<T>::max()), -1.0f);
  }
}

template <typename T>
void convert(const Elements& elements, size_t first, size_t count, float* out) {
  const uint8_t* from = elements.data + first * elements.stride;
  for (size_t i = 0; i < count; ++i, from += elements.stride) {
    for (size_t c = 0; c < elements.components; ++c) {
      *out++ = to_float(value_at<T>(from + c * sizeof(T)), elements.normalized);
    }
  }
}

void convert_floats(const Elements& elements, size_t first, size_t count, float* out) {
  const size_t bytes = elements.components * sizeof(float);
  const uint8_t* from = elements.data + first * elements.stride;
  if (elements.stride == bytes) {
    std::memcpy(out, from, count * bytes);
    return;
  }
  for (size_t i = 0; i < count; ++i) std::memcpy(out + i * elements.components, from + i * elements.stride, bytes);
}

template <typename T>
void copy_indices(const Elements& elements, size_t first, size_t count, uint32_t* out) {
  const uint8_t* from = elements.data + first * elements.stride;
  for (size_t i = 0; i < count; ++i) out[i] = value_at<T>(from + i * elements.stride);
}

uint32_t index_at(const uint8_t* bytes, int type) {
  switch (component_size(type)) {
    case 1:
      return *bytes;
    case 2:
      return value_at<uint16_t>(bytes);
    default:
      return value_at<uint32_t>(bytes);
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
std::span<const uint8_t> element_bytes(const Gltf& gltf, int view, uint64_t offset, uint64_t count, uint64_t stride,
                                       uint64_t element, const std::string& where) {
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

/// Copies the elements into one array and inserts the sparse values.
void gather(const Gltf& gltf, const tinygltf::Accessor& accessor, size_t element, const std::string& where,
            Elements& out) {
  constexpr size_t most_zeros = size_t{1} << 22;  // a few bytes of a file can ask for any number
  if (!out.data && accessor.count > most_zeros) {
    fail(where, "accessor without a buffer view has more than " + std::to_string(most_zeros) + " elements (" +
                    std::to_string(accessor.count) + ")");
  }
  out.own.resize(accessor.count * element);
  for (size_t i = 0; out.data && i < out.count; ++i) {
    std::memcpy(out.own.data() + i * element, out.data + i * out.stride, element);
  }
  out.data = out.own.data();
  out.stride = element;
  if (!accessor.sparse.isSparse) return;
  const auto& sparse = accessor.sparse;
  const auto count = static_cast<size_t>(sparse.count);
  const size_t index_size = component_size(sparse.indices.componentType);
  need_unsigned(sparse.indices.componentType, where + ", sparse indices");
  const auto indices = element_bytes(gltf, sparse.indices.bufferView, static_cast<uint64_t>(sparse.indices.byteOffset),
                                     count, index_size, index_size, where + ", sparse indices");
  const auto values = element_bytes(gltf, sparse.values.bufferView, static_cast<uint64_t>(sparse.values.byteOffset),
                                    count, element, element, where + ", sparse values");
  for (size_t i = 0; i < count; ++i) {
    const uint32_t at = index_at(indices.data() + i * index_size, sparse.indices.componentType);
    if (at >= accessor.count) fail(where + ", sparse indices", "index is out of range (" + std::to_string(at) + ")");
    std::memcpy(out.own.data() + at * element, values.data() + i * element, element);
  }
}

Elements open_elements(const Gltf& gltf, const tinygltf::Accessor& accessor, size_t components,
                       const std::string& where) {
  Elements out;
  out.count = accessor.count;
  out.components = components;
  out.component_type = accessor.componentType;
  out.normalized = accessor.normalized;
  const size_t element = components * component_size(accessor.componentType);
  if (accessor.bufferView >= 0) {
    const auto& view = gltf.model.bufferViews[static_cast<size_t>(accessor.bufferView)];
    out.stride = view.byteStride ? view.byteStride : element;
    out.data = element_bytes(gltf, accessor.bufferView, accessor.byteOffset, accessor.count, out.stride, element, where)
                   .data();
  }
  if (!out.data || accessor.sparse.isSparse) gather(gltf, accessor, element, where, out);
  return out;
}

}  // namespace

size_t component_size(int type) {
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

const tinygltf::Accessor& checked_accessor(const Gltf& gltf, int index, const std::string& where) {
  const tinygltf::Accessor& accessor = gltf.model.accessors[static_cast<size_t>(index)];
  if (accessor.sparse.isSparse && static_cast<uint64_t>(accessor.sparse.count) > accessor.count) {
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

Elements elements_of(const Gltf& gltf, int index, size_t least, size_t most, const std::string& where) {
  const tinygltf::Accessor& accessor = checked_accessor(gltf, index, where);
  const bool vector = accessor.type == TINYGLTF_TYPE_SCALAR ||
                      (accessor.type >= TINYGLTF_TYPE_VEC2 && accessor.type <= TINYGLTF_TYPE_VEC4);
  const size_t components =
      accessor.type == TINYGLTF_TYPE_MAT4 ? 16
      : vector ? static_cast<size_t>(tinygltf::GetNumComponentsInType(static_cast<uint32_t>(accessor.type)))
               : 0;
  if (components < least || components > most) {
    fail(where,
         "accessor " + std::to_string(index) + " has the wrong type (" + std::to_string(components) + " components)");
  }
  return open_elements(gltf, accessor, components, where);
}

size_t to_floats(const Elements& elements, size_t first, size_t count, float* out) {
  switch (elements.component_type) {
    case TINYGLTF_COMPONENT_TYPE_BYTE:
      convert<int8_t>(elements, first, count, out);
      break;
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
      convert<uint8_t>(elements, first, count, out);
      break;
    case TINYGLTF_COMPONENT_TYPE_SHORT:
      convert<int16_t>(elements, first, count, out);
      break;
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
      convert<uint16_t>(elements, first, count, out);
      break;
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
      convert<uint32_t>(elements, first, count, out);
      break;
    default:
      convert_floats(elements, first, count, out);
  }
  const size_t values = count * elements.components;
  uint32_t bad = 0;  // no branch, so that the compiler vectorizes the loop
  for (size_t i = 0; i < values; ++i) {
    const auto bits = std::bit_cast<uint32_t>(out[i]);
    bad |= uint32_t{(bits & 0x7F800000u) == 0x7F800000u};
  }
  if (!bad) return SIZE_MAX;
  for (size_t i = 0;; ++i) {
    if (!std::isfinite(out[i])) return first + i / elements.components;
  }
}

void fail_not_finite(const Elements& elements, size_t element, const std::string& where) {
  std::vector<float> values(elements.components);
  to_floats(elements, element, 1, values.data());
  for (const float value : values) {
    if (!std::isfinite(value)) {
      fail(where, "value is not finite (" + std::to_string(value) + " in element " + std::to_string(element) + ")");
    }
  }
  fail(where, "value is not finite");
}

Floats read_floats(const Gltf& gltf, int index, size_t least_components, size_t most_components,
                   const std::string& where) {
  const Elements elements = elements_of(gltf, index, least_components, most_components, where);
  Floats out{elements.count, elements.components, std::vector<float>(elements.count * elements.components)};
  const size_t bad = to_floats(elements, 0, elements.count, out.values.data());
  if (bad != SIZE_MAX) fail_not_finite(elements, bad, where);
  return out;
}

std::vector<uint32_t> read_indices(const Gltf& gltf, int index, uint64_t end, const std::string& where) {
  const tinygltf::Accessor& accessor = checked_accessor(gltf, index, where);
  if (accessor.type != TINYGLTF_TYPE_SCALAR) fail(where, "accessor " + std::to_string(index) + " is not SCALAR");
  need_unsigned(accessor.componentType, where);
  const Elements elements = open_elements(gltf, accessor, 1, where);
  std::vector<uint32_t> out(elements.count);
  FirstFault fault;
  for_blocks(out.size(), [&](size_t first, size_t count) {
    const size_t size = component_size(elements.component_type);
    const auto copy = size == 1 ? copy_indices<uint8_t> : size == 2 ? copy_indices<uint16_t> : copy_indices<uint32_t>;
    copy(elements, first, count, out.data() + first);
    uint32_t largest = 0;
    for (size_t i = first; i < first + count; ++i) largest = std::max(largest, out[i]);
    if (largest < end) return;
    fault.note(static_cast<size_t>(
        std::find_if(out.begin() + first, out.end(), [&](uint32_t value) { return value >= end; }) - out.begin()));
  });
  if (fault.at() != SIZE_MAX) {
    fail(where, "index is out of range, there are " + std::to_string(end) + " vertices (" +
                    std::to_string(out[fault.at()]) + " at " + std::to_string(fault.at()) + ")");
  }
  return out;
}

void for_blocks(size_t count, const std::function<void(size_t, size_t)>& work) {
  constexpr size_t block_size = 1024;  // vertices: 60 KiB, which stay in the cache for all attributes
  constexpr size_t at_once = 16;       // blocks per task
  tbb::parallel_for(tbb::blocked_range<size_t>(0, (count + block_size - 1) / block_size, at_once),
                    [&](const auto& range) {
                      for (size_t block = range.begin(); block < range.end(); ++block) {
                        work(block * block_size, std::min(block_size, count - block * block_size));
                      }
                    });
}

void FirstFault::note(size_t at) {
  size_t seen = at_.load();
  while (at < seen && !at_.compare_exchange_weak(seen, at)) {
  }
}

}  // namespace chandelier::baker
