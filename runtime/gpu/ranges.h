// SPDX-License-Identifier: Apache-2.0
// Hands out ranges of a block, as the allocator does with device memory.
#pragma once

#include <cstdint>
#include <map>
#include <optional>

namespace chandelier::gpu {

class Ranges {
 public:
  explicit Ranges(uint64_t size) : size_(size) { free_.emplace(0, size); }

  /// Where `size` units (at least one) begin, at a multiple of `alignment`; nothing where no gap is large enough. Takes
  /// the first gap that fits.
  std::optional<uint64_t> take(uint64_t size, uint64_t alignment);
  /// Gives back what take() returned for this size. Neighbouring gaps become one.
  void give_back(uint64_t offset, uint64_t size);
  bool is_empty() const { return free_.size() == 1 && free_.begin()->second == size_; }

 private:
  uint64_t size_;
  std::map<uint64_t, uint64_t> free_;  // gaps: offset, size
};

}  // namespace chandelier::gpu
