// SPDX-License-Identifier: Apache-2.0
// Reads accessors of any component type and stride, sparse ones too.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>

#include "gltf.h"

namespace chandelier::baker {

/// Returns the accessor after a check that its count is at most the number of bytes of its buffer view. Throws Error.
const tinygltf::Accessor& checked_accessor(const Gltf& gltf, int accessor, const std::string& where);

/// An accessor's elements: in their buffer, or in `own` if they had to be copied or decoded. Each of the `count`
/// elements at `data + i * stride` has `components` values of `component_type` that may be read.
struct Elements {
  const uint8_t* data = nullptr;
  size_t stride = 0;
  size_t count = 0;
  size_t components = 0;
  int component_type = 0;
  bool normalized = false;
  std::vector<uint8_t> own;  // sparse data, data without a buffer view, data from a decoder
};

size_t component_size(int component_type);

/// Reads vectors of `least` to `most` components, or matrices if both are 16. Throws Error.
Elements elements_of(const Gltf& gltf, int accessor, size_t least, size_t most, const std::string& where);

/// Converts `count` elements from `first` on into a packed array. Normalized integers are mapped to 0..1 or -1..1.
/// Returns the number of the first element among all that is not finite, or SIZE_MAX.
size_t to_floats(const Elements& elements, size_t first, size_t count, float* out);

[[noreturn]] void fail_not_finite(const Elements& elements, size_t element, const std::string& where);

/// All elements of an accessor as floats. Throws Error if a value is not finite.
struct Floats {
  size_t count = 0;
  size_t components = 0;
  std::vector<float> values;
};
Floats read_floats(const Gltf& gltf, int accessor, size_t least_components, size_t most_components,
                   const std::string& where);

/// Unsigned integers of a scalar accessor, each below `end`. Throws Error.
std::vector<uint32_t> read_indices(const Gltf& gltf, int accessor, uint64_t end, const std::string& where);

/// Calls `work(first, count)` for blocks of `count` items, in parallel if there are many.
void for_blocks(size_t count, const std::function<void(size_t, size_t)>& work);

/// The smallest number that any block reports, whichever reports first in time; SIZE_MAX: none.
class FirstFault {
 public:
  void note(size_t at);
  size_t at() const { return at_.load(); }

 private:
  std::atomic<size_t> at_{SIZE_MAX};
};

}  // namespace chandelier::baker
